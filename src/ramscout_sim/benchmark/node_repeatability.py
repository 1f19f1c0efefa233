#!/usr/bin/python3
"""Runs the simulator node several times and compares every byte it publishes.

Every run is stepped; some have no listener for the first half, some two listeners. The SHA-256 is that of all
messages of each topic in the second half, without the sequence numbers that roscpp counts per publisher.

Usage: roscore & /usr/bin/python3 src/ramscout_sim/benchmark/node_repeatability.py WORLD TOUR ROBOT [RUNS [SECONDS]]
"""
import hashlib
import subprocess
import sys
import threading
import time

import rospy
from std_srvs.srv import Empty, SetBool

from ramscout_sim.srv import Step

TOPICS = ["/clock", "scan", "odom", "ground_truth", "joint_states", "/tf"]
CHUNK_S = 0.5
SEQUENCE_BYTES = 4


class Listener:
    def __init__(self):
        self.changed = threading.Condition()
        self.hashes = {name: hashlib.sha256() for name in TOPICS}
        self.counts = dict.fromkeys(TOPICS, 0)
        self.subscribers = [rospy.Subscriber(name, rospy.AnyMsg, self.receive, name, queue_size=10000,
                                             tcp_nodelay=True) for name in TOPICS]
        while any(s.get_num_connections() == 0 for s in self.subscribers):
            time.sleep(0.01)
        time.sleep(0.5)  # until the publishers know, too

    def receive(self, message, name):
        with self.changed:
            skipped = 0 if name in ("/clock", "/tf") else SEQUENCE_BYTES
            self.hashes[name].update(message._buff[skipped:])
            self.counts[name] += 1
            self.changed.notify_all()

    def wait(self, counts):
        """Until as many messages have come; they must come within the patience."""
        with self.changed:
            good = self.changed.wait_for(lambda: all(self.counts[n] >= counts[n] for n in counts), 10.0)
            if not good:
                raise RuntimeError("messages are missing: %s of %s" % (self.counts, counts))

    def digest(self):
        whole = hashlib.sha256()
        for name in TOPICS:
            whole.update(self.hashes[name].digest())
        return whole.hexdigest()

    def stop(self):
        for subscriber in self.subscribers:
            subscriber.unregister()


def advance(step, seconds, listeners):
    for _ in range(int(round(seconds / CHUNK_S))):
        answer = step(CHUNK_S)
        if not answer.success:
            raise RuntimeError(answer.message)
        for listener in listeners:
            listener.expected += CHUNK_S
            listener.wait({"odom": int(100 * listener.expected) - 1, "scan": int(40 * listener.expected) - 1})


def run(parameters, seconds, early, late):
    executable = subprocess.check_output(["catkin_find", "--first-only", "--libexec", "ramscout_sim", "simulator"])
    simulator = subprocess.Popen([executable.decode().strip()] + parameters, stdout=subprocess.DEVNULL)
    listeners = []
    try:
        rospy.wait_for_service("simulator/pause", 20.0)
        rospy.ServiceProxy("simulator/pause", SetBool)(True)
        rospy.ServiceProxy("simulator/reset", Empty)()
        step = rospy.ServiceProxy("simulator/step", Step)
        for _ in range(early):
            listeners.append(Listener())
            listeners[-1].expected = 0.0
        advance(step, 0.5 * seconds, listeners)
        time.sleep(1.0)  # what is on its way belongs to the first half
        for listener in listeners:
            listener.hashes = {name: hashlib.sha256() for name in TOPICS}
        for _ in range(late):
            listeners.append(Listener())
            listeners[-1].expected = 0.0
        advance(step, 0.5 * seconds, listeners)
        time.sleep(1.0)
        return {listener.digest() for listener in listeners}
    finally:
        for listener in listeners:
            listener.stop()
        simulator.terminate()
        simulator.wait()


def main():
    world, tour, robot = sys.argv[1:4]
    runs = int(sys.argv[4]) if len(sys.argv) > 4 else 10
    seconds = float(sys.argv[5]) if len(sys.argv) > 5 else 600.0
    rospy.init_node("node_repeatability")
    parameters = ["_world:=" + world, "_tour:=" + tour, "_robot:=" + robot, "_real_time_factor:=0.0"]
    digests = set()
    for index in range(runs):
        early, late = [(1, 0), (0, 1), (2, 0)][index % 3]
        begin = time.time()
        found = run(parameters, seconds, early, late)
        digests |= found
        print("run %d, %d listeners from the start, %d from the middle: %s (%.0f s)"
              % (index, early, late, " ".join(sorted(found)), time.time() - begin), flush=True)
    print("all the same" if len(digests) == 1 else "%d DIFFERENT RESULTS" % len(digests))
    sys.exit(0 if len(digests) == 1 else 1)


if __name__ == "__main__":
    main()
