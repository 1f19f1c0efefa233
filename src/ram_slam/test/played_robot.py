"""A robot that drives along x at 0.5 m/s past poles: what fast_slam gets from it, and what comes back.

Kinematics is a server in here, which can refuse and go away.
"""
import math
import time
import unittest

import rospy
import tf2_ros
from geometry_msgs.msg import PoseWithCovarianceStamped, TransformStamped
from ram_slam_msgs.msg import Feature, FeatureList, LandmarkMap
from ram_slam_msgs.srv import PredictStateWithCovariance, PredictStateWithCovarianceResponse
from std_msgs.msg import Bool

TIMEOUT_S = 10.0
PERIOD_S = 0.1
SPEED = 0.5
POLES = [(x + 0.7 * (i % 3), 2.0 - 4.0 * (i % 2)) for i, x in enumerate(range(1, 60, 2))]
VARIANCE = 1e-4


def wait_until(condition, timeout=TIMEOUT_S):
    deadline = time.time() + timeout
    while time.time() < deadline:
        if condition():
            return True
        time.sleep(0.01)
    return False


def feature(x, y, variance=VARIANCE):
    message = Feature()
    message.type = "pole"
    message.pose.pose.position.x = x
    message.pose.pose.position.y = y
    message.pose.pose.orientation.w = 1.0
    message.pose.covariance = [0.0] * 36
    message.pose.covariance[0] = message.pose.covariance[7] = variance
    for i in (14, 21, 28, 35):
        message.pose.covariance[i] = 1e6
    return message


class Topic:
    """What came on a topic."""

    def __init__(self, name, kind):
        self.messages = []
        self.subscriber = rospy.Subscriber(name, kind, self.messages.append, queue_size=1000, tcp_nodelay=True)


class PlayedRobot(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.pose = Topic("pose", PoseWithCovarianceStamped)
        cls.lost = Topic("lost", Bool)
        cls.landmarks = Topic("landmarks", LandmarkMap)
        cls.features = rospy.Publisher("features", FeatureList, queue_size=100, tcp_nodelay=True)
        cls.broadcaster = tf2_ros.TransformBroadcaster()
        cls.service = None
        cls.used = False
        cls.odometry_from = cls.odometry_to = 0.0
        cls.now = math.floor(time.time())  # stamps near the wall clock, which tf consumers use
        cls.start = cls.now
        cls.serve()

    @classmethod
    def serve(cls):
        cls.service = rospy.Service("kinematics/predict_with_covariance", PredictStateWithCovariance, cls.predict)

    @classmethod
    def predict(cls, request):
        start, end = request.from_.to_sec(), request.to.to_sec()
        if start < cls.odometry_from - 1e-6 or end > cls.odometry_to + 1e-6:
            return None
        moved = SPEED * (end - start)
        variance = 1e-6 + 1e-5 * moved
        return PredictStateWithCovarianceResponse(
            [moved, 0.0, 0.0], [variance, 0, 0, 0, variance, 0, 0, 0, 0.1 * variance])

    @classmethod
    def x(cls, stamp=None):
        return SPEED * ((cls.now if stamp is None else stamp) - cls.start)

    @classmethod
    def begin(cls):
        """The next reading is the first one of a drive."""
        # Stamps never go back from test to test, or tf would drop them.
        cls.now = max(cls.now + 5.0, math.floor(time.time())) if cls.used else math.floor(time.time())
        cls.used = True
        cls.start = cls.now + PERIOD_S  # the first reading's place is the map's origin
        cls.odometry_from = cls.now - 10.0
        cls.odometry_to = cls.now

    def list_at(self, stamp):
        message = FeatureList()
        message.header.stamp = rospy.Time.from_sec(stamp)
        message.header.frame_id = "base_link"
        x = self.x(stamp)
        message.features = [feature(px - x, py) for px, py in POLES if abs(px - x) < 6.0]
        return message

    def step(self, odometry=True):
        """One reading further; returns its stamp."""
        cls = type(self)
        cls.now = round(cls.now + PERIOD_S, 3)
        if odometry:
            cls.odometry_to = cls.now
        transform = TransformStamped()
        transform.header.stamp = rospy.Time.from_sec(cls.now)
        transform.header.frame_id = "odom"
        transform.child_frame_id = "base_link"
        transform.transform.translation.x = self.x()
        transform.transform.rotation.w = 1.0
        self.broadcaster.sendTransform(transform)
        self.features.publish(self.list_at(cls.now))
        return cls.now

    def answered(self, stamp, timeout=TIMEOUT_S):
        return wait_until(lambda: any(abs(m.header.stamp.to_sec() - stamp) < 1e-6 for m in self.pose.messages),
                          timeout)

    def drive(self, count):
        for _ in range(count):
            stamp = self.step()
            self.assertTrue(self.answered(stamp), "no pose for a list")
        return self.pose.messages[-1]
