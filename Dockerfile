# The program with Mesa's software driver. It reads scenes and writes results in the folder that is mounted:
# docker build --tag localshape . && docker run --rm --volume "$PWD:/work" localshape render scenes/fig4b.toml
FROM rust:1-bookworm AS build
WORKDIR /source
COPY . .
RUN CARGO_PROFILE_RELEASE_STRIP=true cargo install --locked --path . --root /built

FROM debian:bookworm-slim
RUN apt-get update \
    && apt-get install --yes --no-install-recommends libvulkan1 mesa-vulkan-drivers \
    && rm -rf /var/lib/apt/lists/*
COPY --from=build /built/bin/localshape /usr/local/bin/localshape
WORKDIR /work
ENTRYPOINT ["localshape"]
