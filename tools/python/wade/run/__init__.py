"""A producer of water and the crowd as processes of one run."""
