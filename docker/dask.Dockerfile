# The image with what a Dask cluster takes beside: docker/dask.compose.yaml. Built from the image "stepscope".
FROM stepscope
USER 0
COPY docker/dask-requirements.txt /tmp/
# Each file is the one that was looked at when the list was written.
RUN /usr/local/bin/pip --python /opt/stepscope/bin/python install --no-cache-dir --no-deps --only-binary :all: \
    --require-hashes --requirement /tmp/dask-requirements.txt
USER 10001
