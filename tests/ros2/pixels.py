"""OpenCV decodes the compressed images that topics.py has received, and compares them with the images (`.ci/ros2`).

pixels.py FOLDER...
"""

import sys
from pathlib import Path

import cv2
import numpy as np

files = [file for folder in sys.argv[1:] for file in sorted(Path(folder).glob("*.npz"))]
assert files, "no images"
for file in files:
    image = np.load(file)
    pixels, encoded, form = image["pixels"], image["encoded"], str(image["form"])
    decoded = cv2.imdecode(encoded, cv2.IMREAD_UNCHANGED)
    assert pixels.std() > 1, f"{file}: nothing is seen"
    assert (decoded.shape, decoded.dtype) == (pixels.shape, pixels.dtype), (file, decoded.shape, decoded.dtype)
    assert encoded.nbytes < pixels.nbytes, (file, encoded.nbytes)
    if "png" in form:
        assert encoded[:4].tobytes() == b"\x89PNG" and np.array_equal(decoded, pixels), f"{file}: other pixels"
        print(f"{file.name}: {form}, {encoded.nbytes} bytes, the same pixels")
    else:
        # OpenCV has blue first.
        noise = cv2.PSNR(decoded, np.ascontiguousarray(pixels[..., ::-1]))
        assert encoded[:3].tobytes() == b"\xff\xd8\xff" and noise > 35, f"{file}: {noise:.1f} dB"
        print(f"{file.name}: {form}, {encoded.nbytes} bytes, {noise:.1f} dB")
