#!/usr/bin/env python3
"""Convert images to OpenCV with cv_bridge, and draw moving pixels green. Show them in a window, or save one image.

pictures.py [FILE.png]    for another camera: pictures.py image_raw:=/camera/rgb/image_raw
"""

import sys

import cv2
import rospy
from cv_bridge import CvBridge
from sensor_msgs.msg import Image

THRESHOLD = 40  # of 255: far above the camera's noise
bridge, before = CvBridge(), None


def look(message):
    global before
    picture = bridge.imgmsg_to_cv2(message, "bgr8")
    now = cv2.GaussianBlur(cv2.cvtColor(picture, cv2.COLOR_BGR2GRAY), (5, 5), 0)
    moved = None if before is None else cv2.absdiff(now, before) > THRESHOLD
    before = now
    if moved is None:
        return
    shown = picture.copy()  # the bytes of the message are read-only
    shown[moved] = 0, 255, 0
    if save:
        cv2.imwrite(save, shown)
        rospy.signal_shutdown("one is enough")
    else:
        cv2.imshow("pictures", shown)
        cv2.waitKey(1)


save = next(iter(rospy.myargv(sys.argv)[1:]), None)
rospy.init_node("pictures")
rospy.Subscriber("image_raw", Image, look, queue_size=1, buff_size=1 << 24)
rospy.spin()
