#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The world map as a node: what it keeps, answers, saves and loads, and what it refuses."""
import os
import struct
import sys
import time
import unittest

import rospy
import rostest
from geometry_msgs.msg import PoseStamped
from nav_msgs.msg import OccupancyGrid, Path
from nav_msgs.srv import GetMap
from ram_slam_msgs.msg import ColoredCloud, CovarianceBlock, Landmark, LandmarkMap, LocalOccupancy
from ram_slam_msgs.srv import GetRegion, LoadMap, SaveMap
from sensor_msgs.msg import PointField

TIMEOUT_S = 10.0


def fill_header(header, frame='map', stamp=5.0):
    header.frame_id = frame
    header.stamp = rospy.Time.from_sec(stamp)


def grid_message(cells, width, x=0.0, frame='map', stamp=5.0):
    message = OccupancyGrid()
    fill_header(message.header, frame, stamp)
    message.info.resolution = 0.5
    message.info.width = width
    message.info.height = len(cells) // width
    message.info.origin.position.x = x
    message.info.origin.orientation.w = 1.0
    message.data = cells
    return message


def landmark(identifier, x, y):
    message = Landmark()
    message.id = identifier
    fill_header(message.feature.header)
    message.feature.type = 'corner'
    message.feature.classifier = 'pg1:abc'
    message.feature.pose.pose.position.x = x
    message.feature.pose.pose.position.y = y
    message.feature.pose.pose.orientation.w = 1.0
    message.feature.pose.covariance = [1e-4 if i % 7 == 0 else 0.0 for i in range(36)]
    message.existence_log_odds = 3.0
    return message


def landmark_map(*landmarks, blocks=()):
    message = LandmarkMap()
    fill_header(message.header)
    message.landmarks = landmarks
    message.covariances = blocks
    return message


def cloud_message(points):
    message = ColoredCloud()
    fill_header(message.header)
    message.pose.pose.orientation.w = 1.0
    cloud = message.cloud
    fill_header(cloud.header, 'camera')
    cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1) for i, name in enumerate(('x', 'y', 'z', 'rgb'))]
    cloud.point_step = 16
    cloud.width = len(points)
    cloud.height = 1
    cloud.row_step = 16 * len(points)
    cloud.data = b''.join(struct.pack('<fffI', *point) for point in points)
    return message


class WorldMapNodeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = rospy.get_param('world_map/map_folder')
        for name, service in ('get_region', GetRegion), ('save_map', SaveMap), ('load_map', LoadMap):
            rospy.wait_for_service('world_map/' + name, TIMEOUT_S)
            setattr(cls, name, staticmethod(rospy.ServiceProxy('world_map/' + name, service)))
        for topic, kind in ('map', OccupancyGrid), ('local_occupancy', LocalOccupancy), ('landmarks', LandmarkMap), \
                ('colored_cloud', ColoredCloud), ('trajectory', Path):
            publisher = rospy.Publisher(topic, kind, queue_size=10)
            setattr(cls, topic, publisher)
            deadline = time.time() + TIMEOUT_S
            while publisher.get_num_connections() == 0:
                assert time.time() < deadline, topic
                time.sleep(0.01)

    def region(self, box, condition=lambda answer: True):
        """The region as soon as it fulfils the condition; messages arrive when they do."""
        deadline = time.time() + TIMEOUT_S
        answer = self.get_region(*box)
        while not condition(answer):
            self.assertLess(time.time(), deadline, answer)
            time.sleep(0.02)
            answer = self.get_region(*box)
        self.assertTrue(answer.success, answer.message)
        return answer

    def fill(self):
        block = CovarianceBlock(1, 2, [1e-5] * 9)
        self.map.publish(grid_message([0, 100, -1, 0], 2))
        self.landmarks.publish(landmark_map(landmark(1, 0.2, 0.2), landmark(2, 0.8, 0.8), landmark(7, 50.0, 50.0),
                                            blocks=[block]))
        self.colored_cloud.publish(cloud_message([(0.1, 0.1, 1.0, 0xff0000), (float('nan'), 0.0, 0.0, 1),
                                                  (9.0, 9.0, 1.0, 0x00ff00)]))
        path = Path()
        fill_header(path.header)
        for i in range(3):
            pose = PoseStamped()
            fill_header(pose.header, stamp=1.0 + i)
            pose.pose.orientation.w = 1.0
            path.poses.append(pose)
        self.trajectory.publish(path)
        return self.region((0.0, 0.0, 1.0, 1.0), lambda answer: len(answer.grid.data) == 4 and
                           len(answer.landmarks.landmarks) == 2 and len(answer.clouds) == 1)

    def test_region_holds_what_was_published(self):
        answer = self.fill()
        self.assertEqual(list(answer.grid.data), [0, 100, -1, 0])
        self.assertEqual(answer.grid.header.frame_id, 'map')
        self.assertEqual([entry.id for entry in answer.landmarks.landmarks], [1, 2])
        self.assertEqual(answer.landmarks.landmarks[0].feature.classifier, 'pg1:abc')
        self.assertEqual(answer.landmarks.landmarks[1].feature.pose.covariance[7], 1e-4)
        self.assertEqual(answer.landmarks.covariances[0].covariance, tuple([1e-5] * 9))
        cloud = answer.clouds[0].cloud
        self.assertEqual((cloud.width, cloud.height, cloud.header.frame_id), (1, 1, 'camera'))
        rgb = [field.offset for field in cloud.fields if field.name == 'rgb'][0]
        self.assertEqual(struct.unpack_from('<I', cloud.data, rgb)[0], 0xff0000)

    def test_local_grid_is_drawn_where_its_pose_states(self):
        self.fill()
        local = LocalOccupancy()
        fill_header(local.header, stamp=6.0)
        local.pose.pose.position.x = 100.0
        local.pose.pose.orientation.w = 1.0
        local.grid = grid_message([100], 1, frame='room', stamp=6.0)
        self.local_occupancy.publish(local)
        answer = self.region((99.9, 0.0, 100.4, 0.4), lambda answer: 100 in answer.grid.data)
        self.assertEqual(list(answer.grid.data), [-1, 100])

    def test_saved_map_comes_back_whole(self):
        before = self.fill()
        saved = self.save_map('office-1.2')
        self.assertTrue(saved.success, saved.message)
        self.assertEqual(sorted(os.listdir(os.path.join(self.folder, 'office-1.2'))), ['map.pgm', 'map.world', 'map.yaml'])
        self.map.publish(grid_message([100] * 4, 2, stamp=9.0))
        self.landmarks.publish(landmark_map())
        self.region((0.0, 0.0, 1.0, 1.0), lambda answer: list(answer.grid.data) == [100] * 4 and
                    not answer.landmarks.landmarks)
        loaded = self.load_map('office-1.2')
        self.assertTrue(loaded.success, loaded.message)
        self.assertEqual(self.region((0.0, 0.0, 1.0, 1.0)), before)

    def test_a_map_of_an_earlier_version_is_loaded_from_its_file(self):
        before = self.fill()
        self.assertTrue(self.save_map('newer').success)
        os.rename(os.path.join(self.folder, 'newer', 'map.world'), os.path.join(self.folder, 'older.world'))
        loaded = self.load_map('older')
        self.assertTrue(loaded.success, loaded.message)
        self.assertEqual(self.region((0.0, 0.0, 1.0, 1.0)), before)

    def test_the_grid_of_the_whole_map_is_served(self):
        self.fill()
        self.assertEqual(list(rospy.ServiceProxy('static_map', GetMap)().map.data), [0, 100, -1, 0])

    def test_corrupted_file_is_refused_and_the_map_stays(self):
        before = self.fill()
        self.assertTrue(self.save_map('good').success)
        os.makedirs(os.path.join(self.folder, 'bad'), exist_ok=True)
        path = os.path.join(self.folder, 'bad', 'map.world')
        with open(os.path.join(self.folder, 'good', 'map.world'), 'rb') as file:
            content = bytearray(file.read())
        for damaged in content[:-1], content + b'x', b'', content[:100] + bytes([content[100] ^ 1]) + content[101:]:
            with open(path, 'wb') as file:
                file.write(damaged)
            answer = self.load_map('bad')
            self.assertFalse(answer.success)
            self.assertIn('bad/map.world', answer.message)
            self.assertEqual(self.region((0.0, 0.0, 1.0, 1.0)), before)

    def test_names_that_leave_the_folder_are_refused(self):
        self.fill()
        for name in '', '../x', '/tmp/x', 'a/b', '.hidden', 'a b', 'x;rm', '$(x)', 'ü', 'x' * 101:
            for service in self.save_map, self.load_map:
                answer = service(name)
                self.assertFalse(answer.success, name)
                self.assertNotEqual(answer.message, '')
        missing = self.load_map('missing')
        self.assertFalse(missing.success)
        self.assertIn('No such file', missing.message)

    def test_bad_messages_change_nothing(self):
        before = self.fill()
        self.map.publish(grid_message([0, 0, 0, 0], 2, frame='odom'))
        self.map.publish(grid_message([0, 0, 0, 101], 2))
        wrong_size = grid_message([0, 0, 0, 0], 2)
        wrong_size.info.height = 7
        self.map.publish(wrong_size)
        self.landmarks.publish(landmark_map(landmark(2, 0.0, 0.0), landmark(1, 0.0, 0.0)))
        self.landmarks.publish(landmark_map(landmark(1, float('nan'), 0.0)))
        short = cloud_message([(0.1, 0.1, 1.0, 0)])
        short.cloud.data = short.cloud.data[:-1]
        self.colored_cloud.publish(short)
        colourless = cloud_message([(0.1, 0.1, 1.0, 0)])
        colourless.cloud.fields = colourless.cloud.fields[:3]
        self.colored_cloud.publish(colourless)
        time.sleep(0.5)
        self.assertEqual(self.region((0.0, 0.0, 1.0, 1.0)), before)

    def test_bad_boxes_are_refused(self):
        self.fill()
        for box in (0.0, 0.0, 0.0, 1.0), (1.0, 0.0, 0.0, 1.0), (float('nan'), 0.0, 1.0, 1.0), (-1e6, -1e6, 1e6, 1e6):
            answer = self.get_region(*box)
            self.assertFalse(answer.success)
            self.assertNotEqual(answer.message, '')


if __name__ == '__main__':
    rospy.init_node('world_map_node_test')
    rostest.rosrun('ram_slam', 'world_map_node', WorldMapNodeTest, sys.argv)
