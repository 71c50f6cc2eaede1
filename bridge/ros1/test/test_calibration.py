#!/usr/bin/env python3
"""External nodes with our cameras: camera_calibration finds their parameters from images of chessboards, and image_proc
rectifies images with them. Needs a master at ROS_MASTER_URI."""

import contextlib
import io
import os
import subprocess
import tempfile
import threading
import unittest

import chessboards
import cv2
import numpy
import rospy
from camera_calibration.calibrator import CAMERA_MODEL, ChessboardInfo, MonoCalibrator, Patterns
from processes import SIMULATOR, Process, bridge, eventually, simulator
from programs import program
from sensor_msgs.msg import CameraInfo, Image

DOMAIN = f"calibration-{os.getpid()}"
FOCAL_TOLERANCE = 0.002
CENTRE_TOLERANCE_PX = 0.6
DISTORTION_TOLERANCE_PX = 0.6  # at the edge of the image
LEAST_PSNR = 35.0  # dB, of the rectified image against a pinhole's
GREY_TOLERANCE = 0.2  # of 255, on average: the table of the lens is in fixed point


def picture(message):
    return numpy.frombuffer(message.data, numpy.uint8).reshape(message.height, message.width)


def project(model, points, camera, lens):
    """Return the pixels of points (x, y, 1) by one of OpenCV's models."""
    points = numpy.column_stack([points, numpy.ones(len(points))])[:, None]
    return model(points, numpy.zeros(3), numpy.zeros(3), camera, lens)[0].reshape(-1, 2)


class Newest:
    """The last messages of several topics."""

    def __init__(self, **topics):
        self.changed, self.last = threading.Condition(), {}
        self.subscribers = [
            rospy.Subscriber(topic, Image if "image" in topic else CameraInfo, self.receive, name, buff_size=1 << 24)
            for name, topic in topics.items()
        ]
        self.names = set(topics)

    def receive(self, message, name):
        with self.changed:
            self.last[name] = message
            self.changed.notify_all()

    def after(self, time_s, timeout=20):
        """Return messages of one stamp later than a time, one of each topic."""

        def complete():
            stamps = {message.header.stamp for message in self.last.values()}
            return self.names == set(self.last) and len(stamps) == 1 and stamps.pop().to_sec() > time_s

        with self.changed:
            assert self.changed.wait_for(complete, timeout), {k: m.header.stamp.to_sec() for k, m in self.last.items()}
            return dict(self.last)

    def close(self):
        for subscriber in self.subscribers:
            subscriber.unregister()


def look_at(board):
    """Move the cameras in front of a board; return the simulated time in s."""
    place = f"0,{board * chessboards.APART_M}"
    command = SIMULATOR, "control", "move", "cameras", place, "--domain", DOMAIN
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=20)
    return float(done.stdout.split()[-2])


class Calibration(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.simulator = simulator(DOMAIN, *chessboards.write(cls.folder.name))
        cls.node = bridge(DOMAIN)
        wanted = {"/straight/image_raw", "/bent/image_raw", "/fisheye/image_raw"}
        assert eventually(lambda: wanted <= set(dict(rospy.get_published_topics()))), cls.node.output() + cls.simulator.output()

    @classmethod
    def tearDownClass(cls):
        cls.node.stop()
        cls.simulator.stop()
        cls.folder.cleanup()

    def calibrated(self, name, model, *flags):
        """Return the result of camera_calibration for a camera, and its published camera_info."""
        board = ChessboardInfo(n_cols=chessboards.COLUMNS, n_rows=chessboards.ROWS, dim=chessboards.SQUARE_M)
        calibrator = MonoCalibrator([board], *flags, pattern=Patterns.Chessboard)
        calibrator.set_cammodel(model)
        camera = Newest(image=f"/{name}/image_raw", info=f"/{name}/camera_info")
        for index in range(chessboards.BOARDS):
            seen = camera.after(look_at(index))
            with contextlib.redirect_stdout(io.StringIO()):
                calibrator.handle_msg(seen["image"])
        camera.close()
        self.assertGreaterEqual(len(calibrator.db), 20, "boards were not found, or too much alike")
        with contextlib.redirect_stdout(io.StringIO()):
            calibrator.do_calibration()
        return calibrator, seen["info"]

    def check(self, calibrator, info, model):
        """Compare the result with the published values; `model` is the OpenCV model that projects points."""
        found, told = calibrator.intrinsics, numpy.reshape(info.K, (3, 3))
        off = numpy.abs(found[[0, 1], [0, 1]] / told[0, 0] - 1)
        centre = numpy.abs(found[:2, 2] - told[:2, 2])
        # At the border of a straight camera's view: the boards reached that far.
        border = numpy.array([[0.0, 0.0], [639.0, 479.0], [0.0, 239.5], [319.5, 0.0]])
        points = (border - [319.5, 239.5]) / chessboards.FOCAL
        drawn = [project(model, points, *lens) for lens in [(found, calibrator.distortion), (told, numpy.array(info.D))]]
        # Relative to the principal point, which was checked above.
        as_found, as_told = (pixels - camera[:2, 2] for pixels, camera in zip(drawn, (found, told)))
        bent = numpy.linalg.norm(as_found - as_told, axis=1).max()
        print(
            f"{len(calibrator.db)} boards: fx {found[0, 0]:.3f}, fy {found[1, 1]:.3f} of {told[0, 0]:.3f} "
            f"({off.max():.4%} off), centre {centre.max():.3f} px off, lens at most {bent:.3f} px off at the border"
        )
        self.assertLess(off.max(), FOCAL_TOLERANCE)
        self.assertLess(centre.max(), CENTRE_TOLERANCE_PX)
        self.assertLess(bent, DISTORTION_TOLERANCE_PX)

    def test_camera_calibration_finds_the_camera(self):
        calibrator, info = self.calibrated("straight", CAMERA_MODEL.PINHOLE, cv2.CALIB_FIX_K3)
        self.assertEqual(info.distortion_model, "plumb_bob")
        self.check(calibrator, info, cv2.projectPoints)

    def test_camera_calibration_finds_the_fisheye(self):
        flags = cv2.fisheye.CALIB_FIX_SKEW | cv2.fisheye.CALIB_RECOMPUTE_EXTRINSIC
        calibrator, info = self.calibrated("fisheye", CAMERA_MODEL.FISHEYE, 0, flags)
        self.assertEqual((info.distortion_model, info.D), ("equidistant", chessboards.FISHEYE))
        self.check(calibrator, info, cv2.fisheye.projectPoints)

    def test_image_proc_takes_the_lens_out_that_camera_info_tells(self):
        with Process(program("image_proc", "image_proc"), ROS_NAMESPACE="/bent") as theirs:
            self.assertTrue(eventually(lambda: "/bent/image_rect" in dict(rospy.get_published_topics()), 20), theirs.output())
            camera = Newest(
                image="/bent/image_raw", info="/bent/camera_info", rectified_image="/bent/image_rect", straight_image="/straight/image_raw"
            )
            seen = camera.after(look_at(0))
            camera.close()
        info, raw, rectified = seen["info"], picture(seen["image"]), picture(seen["rectified_image"])
        self.assertEqual((info.distortion_model, info.D), ("plumb_bob", chessboards.DISTORTION))
        # The same computed here: each pixel of the straight image is taken from where the lens would map it.
        camera, y, x = numpy.reshape(info.K, (3, 3)), *numpy.indices(raw.shape).astype(float)
        x, y = (x - camera[0, 2]) / camera[0, 0], (y - camera[1, 2]) / camera[1, 1]
        (k1, k2, t1, t2, k3), r2 = info.D, x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        bent_x = x * radial + 2 * t1 * x * y + t2 * (r2 + 2 * x * x)
        bent_y = y * radial + t1 * (r2 + 2 * y * y) + 2 * t2 * x * y
        place = camera[0, 0] * bent_x + camera[0, 2], camera[1, 1] * bent_y + camera[1, 2]
        expected = cv2.remap(raw, *(axis.astype(numpy.float32) for axis in place), cv2.INTER_LINEAR)
        self.assertGreater(numpy.abs(place[0] - numpy.indices(raw.shape)[1]).max(), 20, "hardly a lens")
        difference = numpy.abs(rectified[2:-2, 2:-2].astype(int) - expected[2:-2, 2:-2])
        print(f"image_proc's picture differs by {difference.max()} at most, {difference.mean():.4f} on average")
        self.assertLess(difference.mean(), GREY_TOLERANCE)
        # The image of a camera without a lens at the same time and place.
        straight = picture(seen["straight_image"])[2:-2, 2:-2].astype(float)
        psnr = 10 * numpy.log10(255**2 / numpy.square(rectified[2:-2, 2:-2] - straight).mean())
        beside = 10 * numpy.log10(255**2 / numpy.square(rectified[2:-2, 3:-1] - straight).mean())
        print(f"the rectified picture and a pinhole's: PSNR {psnr:.1f} dB, a pixel beside {beside:.1f} dB")
        self.assertGreaterEqual(psnr, LEAST_PSNR)


if __name__ == "__main__":
    rospy.init_node("belvedere_calibration_test", disable_signals=True)
    unittest.main(verbosity=2, warnings="ignore")
