#!/usr/bin/python3
"""How fast the simulator node runs with one subscriber to its scans: simulated seconds per CPU and per wall second.

The simulator has processor 0 to itself as far as this program can arrange.

Usage: roscore & /usr/bin/python3 src/ramscout_sim/benchmark/node_speed.py WORLD TOUR ROBOT [key:=value of the simulator ...]
"""
import os
import subprocess
import sys
import threading
import time

import rospy
from rosgraph_msgs.msg import Clock
from std_srvs.srv import SetBool

WARM_UP_S = 2.0
MEASURE_S = 10.0


def cpu_s(pid):
    with open("/proc/%d/stat" % pid) as stat:
        fields = stat.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def main():
    world, tour, robot = sys.argv[1:4]
    parameters = ["_world:=" + world, "_tour:=" + tour, "_robot:=" + robot, "_real_time_factor:=0.0"]
    parameters += ["_" + argument for argument in sys.argv[4:]]
    executable = subprocess.check_output(["catkin_find", "--first-only", "--libexec", "ramscout_sim", "simulator"])
    simulator = subprocess.Popen([executable.decode().strip()] + parameters, stdout=subprocess.DEVNULL,
                                 preexec_fn=lambda: os.sched_setaffinity(0, {0}))
    try:
        rospy.init_node("node_speed")
        counted = {"scans": 0, "clock": 0.0}
        lock = threading.Lock()

        def on_scan(_):
            with lock:
                counted["scans"] += 1

        rospy.Subscriber("scan", rospy.AnyMsg, on_scan, queue_size=1000, tcp_nodelay=True)
        rospy.wait_for_service("simulator/pause", 20.0)
        time.sleep(WARM_UP_S)
        pause = rospy.ServiceProxy("simulator/pause", SetBool)
        # The clock is asked for at both ends only, so that scans have the one subscriber.
        begin = rospy.wait_for_message("/clock", Clock).clock.to_sec()
        cpu, wall, scans = cpu_s(simulator.pid), time.time(), counted["scans"]
        time.sleep(MEASURE_S)
        end = rospy.wait_for_message("/clock", Clock).clock.to_sec()
        cpu, wall, scans = cpu_s(simulator.pid) - cpu, time.time() - wall, counted["scans"] - scans
        asked = time.time()
        pause(True)
        answered = time.time()
        memory_mb = int(open("/proc/%d/statm" % simulator.pid).read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
        print("%.1f simulated s in %.2f s of CPU (%.0fx) and %.2f s of wall time (%.0fx); %d scans received; "
              "pause answered after %.1f ms; %.0f MB; load %.1f"
              % (end - begin, cpu, (end - begin) / cpu, wall, (end - begin) / wall, scans,
                 1e3 * (answered - asked), memory_mb, os.getloadavg()[0]))
    finally:
        simulator.terminate()
        simulator.wait()


if __name__ == "__main__":
    main()
