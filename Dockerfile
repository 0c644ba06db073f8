# Wade on Debian 12: the image is built with the programs, `docker run` runs the main job, or any command of tools/wade.
#   docker build -t wade .
#   docker run --rm --shm-size 256m -v "$PWD/runs:/wade/runs" wade                 # tools/run.sh
#   docker run --rm --shm-size 256m wade tools/test.sh                             # the tests
FROM debian:bookworm-slim
RUN apt-get update && apt-get install --yes --no-install-recommends ca-certificates git && rm -rf /var/lib/apt/lists/*
WORKDIR /wade
COPY . .
RUN tools/install_dependencies.sh && \
    cmake --preset release -DWADE_BUILD_TESTS=OFF && ninja -C build/release fluid_server crowd_client
CMD ["tools/run.sh"]
