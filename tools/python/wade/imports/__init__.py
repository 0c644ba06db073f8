"""Import of sites: terrain and houses of any format that GDAL reads."""
