"""Reads a data set with independent programs: webdataset, pycocotools, numpy, Pillow."""

import hashlib
import json
import pathlib
import sys

import numpy as np
import webdataset as wds
from PIL import Image
from pycocotools.coco import COCO
from pycocotools.cocoeval import COCOeval

out = pathlib.Path(sys.argv[1])
manifest = json.loads((out / "manifest.json").read_text())
for shard in manifest["shards"]:
    data = (out / shard["name"]).read_bytes()
    assert (len(data), hashlib.sha256(data).hexdigest()) == (shard["bytes"], shard["sha256"]), shard

urls = [str(out / shard["name"]) for shard in manifest["shards"]]
samples = {}
for sample in wds.WebDataset(urls, shardshuffle=False).decode("rgb8"):
    known = sample["json"]["sensors"]["rgb"]
    size = (known["height"], known["width"])
    assert sample["rgb.png"].shape == (*size, 3)
    assert sample["rgb.png"].dtype == np.uint8
    assert sample["rgb.depth.npy"].shape == size
    assert sample["rgb.depth.npy"].dtype == np.float32
    assert sample["rgb.instance.npy"].shape == size
    assert sample["rgb.instance.npy"].dtype == np.int32
    assert sample["rgb.flow_back.npy"].shape == (*size, 2)
    # A pixel shows an object if and only if it has a finite depth and a class.
    seen = sample["rgb.instance.npy"] >= 0
    assert (seen == np.isfinite(sample["rgb.depth.npy"])).all()
    assert (seen == (sample["rgb.class.npy"] > 0)).all()
    cloud = sample["cloud.npy"]
    points = np.stack([cloud[axis] for axis in "xyz"], axis=-1)
    assert np.isfinite(points).any()
    assert cloud["ring"].max() <= 15
    samples[int(sample["__key__"])] = sample
assert sorted(samples) == list(range(manifest["samples"])), "samples are missing"

coco = COCO(out / "coco" / "rgb" / "instances.json")
assert sorted(coco.getImgIds()) == sorted(samples)
for image in coco.loadImgs(coco.getImgIds()):
    sample = samples[image["id"]]
    picture = np.asarray(Image.open(out / "coco" / "rgb" / "images" / image["file_name"]))
    assert (picture == sample["rgb.png"]).all()
    objects = sample["json"]["sensors"]["rgb"]["objects"]
    annotations = coco.loadAnns(coco.getAnnIds(image["id"]))
    assert len(annotations) == len(objects)
    union = np.zeros(picture.shape[:2], dtype=int)
    for annotation, thing in zip(annotations, objects, strict=True):
        mask = coco.annToMask(annotation).astype(bool)
        assert (mask == np.isin(sample["rgb.instance.npy"], thing["instances"])).all()
        rows, columns = np.nonzero(mask)
        left, top, width, height = annotation["bbox"]
        assert (columns.min(), rows.min()) == (left, top)
        assert (columns.max(), rows.max()) == (left + width - 1, top + height - 1)
        assert annotation["area"] == mask.sum()
        assert coco.loadCats(annotation["category_id"])[0]["name"] == thing["category"]
        union += mask
    # Each pixel belongs to one object, or to none.
    assert (union == (sample["rgb.instance.npy"] >= 0)).all()

# If the ground truth is submitted as the result, everything is found.
found = [
    {**{key: annotation[key] for key in ("image_id", "category_id", "bbox")}, "score": 1.0}
    for annotation in coco.dataset["annotations"]
]
evaluation = COCOeval(coco, coco.loadRes(found), "bbox")
evaluation.evaluate()
evaluation.accumulate()
evaluation.summarize()
assert evaluation.stats[0] == 1.0, evaluation.stats

# KITTI's boxes: the corners of objects entirely in the picture are around their boxes of pixels.
training, checked = out / "kitti" / "rgb" / "training", 0
for index, sample in samples.items():
    calibration = (training / "calib" / f"{index:06}.txt").read_text().splitlines()
    matrices = {
        name: np.array(numbers.split(), float) for name, numbers in (line.split(": ") for line in calibration)
    }
    projection = matrices["P2"].reshape(3, 4)
    picture = np.asarray(Image.open(training / "image_2" / f"{index:06}.png"))
    assert (picture == sample["rgb.png"]).all()
    for line in (training / "label_2" / f"{index:06}.txt").read_text().splitlines():
        fields = line.split()
        assert len(fields) == 15, line
        truncated, _, _, left, top, right, bottom, height, width, length, x, y, z, yaw = map(float, fields[1:])
        # KITTI's boxes are upright in the camera's frame, which is only correct if the camera is level.
        roll_pitch = sample["json"]["sensors"]["rgb"]["world_from_sensor"]["orientation"][:2]
        if truncated > 0 or np.any(np.abs(roll_pitch) > 1e-6):
            continue
        cos, sin = np.cos(yaw), np.sin(yaw)
        turn = np.array([[cos, 0, sin], [0, 1, 0], [-sin, 0, cos]])
        corners = np.array(
            [[a * length / 2, b * height, c * width / 2] for a in (-1, 1) for b in (-1, 0) for c in (-1, 1)]
        )
        corners = corners @ turn.T + [x, y, z]
        pixels = projection @ np.hstack([corners, np.ones((8, 1))]).T
        columns, rows = pixels[:2] / pixels[2]
        # The visible part of the object is within.
        assert columns.min() - 1 <= left <= right <= columns.max() + 1, line
        assert rows.min() - 1 <= top <= bottom <= rows.max() + 1, line
        checked += 1
assert checked > 0

# KITTI's point clouds, transformed to the camera, are as far away as the depths of its pixels.
points_checked = 0
for index, sample in samples.items():
    calibration = (training / "calib" / f"{index:06}.txt").read_text().splitlines()
    matrices = {
        name: np.array(numbers.split(), float) for name, numbers in (line.split(": ") for line in calibration)
    }
    points = np.fromfile(training / "velodyne" / f"{index:06}.bin", np.float32).reshape(-1, 4)
    assert len(points) == sample["cloud.npy"].size
    assert (points[:, 3] >= 0).all()
    assert (points[:, 3] <= 1).all()
    points[:, 3] = 1
    seen = matrices["Tr_velo_to_cam"].reshape(3, 4) @ points.T
    seen = seen[:, seen[2] > 0.3]
    columns, rows = np.rint((matrices["P2"].reshape(3, 4)[:, :3] @ seen)[:2] / seen[2]).astype(int)
    depth = sample["rgb.depth.npy"]
    height, width = depth.shape
    inside = (columns > 0) & (columns < width - 1) & (rows > 0) & (rows < height - 1)
    columns, rows, far = columns[inside], rows[inside], seen[2][inside]
    around = np.stack([depth[rows + down, columns + right] for down in (-1, 0, 1) for right in (-1, 0, 1)])
    # A point of the lidar is not in front of the depth that the camera sees there, except for beams split by an edge,
    # which report a range in between. It can be behind that depth if it is only visible from the lidar.
    assert (far >= around.min(axis=0) - 0.1).mean() > 0.98, index
    lies = far <= around.max(axis=0) + 0.1
    assert lies.mean() > 0.9, (index, lies.mean())
    points_checked += len(lies)
assert points_checked > 10000
print(
    f"{len(samples)} samples by webdataset, {len(found)} masks by pycocotools, "
    f"{checked} boxes and {points_checked} points of KITTI"
)
