"""What the tests of the simulator node share: its topics, its services, patience."""
import threading
import unittest

import rospy

PATIENCE_S = 20.0


class SimulatorTest(unittest.TestCase):
    """`latest` holds the last message of each topic, `call` the simulator's services."""

    @classmethod
    def connect(cls, topics, services):
        """Topics and services by name; services are those of the node /simulator."""
        cls.changed = threading.Condition()
        cls.latest = {}
        for name, kind in topics.items():
            rospy.Subscriber(name, kind, lambda message, name=name: cls.receive(name, message), tcp_nodelay=True)
        cls.call = {}
        for name, kind in services.items():
            rospy.wait_for_service("/simulator/" + name, PATIENCE_S)
            cls.call[name] = rospy.ServiceProxy("/simulator/" + name, kind)

    @classmethod
    def receive(cls, name, message):
        with cls.changed:
            cls.latest[name] = message
            cls.changed.notify_all()

    def wait_for(self, condition, what):
        with self.changed:
            self.assertTrue(self.changed.wait_for(condition, PATIENCE_S), what)
