# What building and testing needs, on Debian 12: docker build -t biopsy . && docker run --rm -it -v "$PWD:/src" biopsy ./dev test
FROM debian:bookworm
RUN apt-get update && apt-get install -y --no-install-recommends ca-certificates git && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY dev .
RUN ./dev setup && rm -rf /var/lib/apt/lists/*
CMD ["bash"]
