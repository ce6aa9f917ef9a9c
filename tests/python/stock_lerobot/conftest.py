"""What lerobot has to be told before it is imported: no network, no cache outside a folder of the tests' own."""

import os
import tempfile

CACHE = tempfile.TemporaryDirectory(prefix="ferntast-lerobot-")
os.environ.update(HF_HUB_OFFLINE="1", HF_HOME=CACHE.name, CUDA_VISIBLE_DEVICES="")
