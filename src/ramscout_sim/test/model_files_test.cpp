// SPDX-License-Identifier: BSD-3-Clause
#include "ramscout_sim/model_files.hpp"

#include <cmath>
#include <limits>
#include <sstream>

#include <gmock/gmock.h>

#include "ramscout_sim/lidar.hpp"
#include "ramscout_sim/map_image.hpp"
#include "ramscout_sim/physics.hpp"
#include "ramscout_sim/random.hpp"

#include "shared.hpp"
#include "temporary_folder.hpp"

namespace ramscout_sim {
namespace {

using ::testing::HasSubstr;
using testing::refusalOf;
using testing::TemporaryFolder;

/// A box of 2 x 1 x 0.5 m in the first octant, as text STL.
std::string boxStl(double scale = 1.0) {
  std::ostringstream text;
  text << "solid box\n";
  const auto facet = [&](std::array<Eigen::Vector3d, 3> corners) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const Eigen::Vector3d& c : corners) {
      text << "vertex " << scale * c.x() << ' ' << scale * c.y() << ' ' << scale * c.z() << '\n';
    }
    text << "endloop\nendfacet\n";
  };
  const Eigen::Vector3d size(2.0, 1.0, 0.5);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.0, 1.0}) {
      Eigen::Vector3d base = Eigen::Vector3d::Zero();
      base[axis] = side * size[axis];
      Eigen::Vector3d u = Eigen::Vector3d::Zero();
      Eigen::Vector3d v = Eigen::Vector3d::Zero();
      u[(axis + 1) % 3] = size[(axis + 1) % 3];
      v[(axis + 2) % 3] = size[(axis + 2) % 3];
      facet({base, base + u, base + u + v});
      facet({base, base + u + v, base + v});
    }
  }
  text << "endsolid box\n";
  return text.str();
}

/// A triangle in the plane x = 1 of the file's axes, 2 units high along its up axis, and a stray
/// line far away.
std::string triangleDae(const std::string& up_axis, double unit_m) {
  const bool z_up = up_axis == "Z_UP";
  std::ostringstream text;
  text
      << R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter=")"
      << unit_m << R"("/><up_axis>)" << up_axis << R"(</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="15">)"
      << (z_up ? "1 0 0  1 3 0  1 0 2" : "1 0 0  1 0 -3  1 2 0")
      << R"(  900 900 900  901 900 900</float_array>
<technique_common><accessor source="#a" count="5" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
<lines count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>3 4</p></lines>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>
)";
  return text.str();
}

Eigen::AlignedBox3d boundsOfMesh(const TriangleMesh& mesh) {
  Eigen::AlignedBox3d bounds;
  for (const Eigen::Vector3f& vertex : mesh.vertices_m) bounds.extend(vertex.cast<double>());
  return bounds;
}

TEST(ReadMesh, ReadsStlAsMetresWithZUp) {
  const TemporaryFolder folder;
  const TriangleMesh mesh = readMesh(folder.write("box.stl", boxStl()));
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(mesh.vertices_m.size(), 8u) << "shared corners are one vertex";
  EXPECT_TRUE(boundsOfMesh(mesh).max().isApprox(Eigen::Vector3d(2.0, 1.0, 0.5)));
  EXPECT_NEAR(boundsOfMesh(mesh).min().norm(), 0.0, 1e-12);
}

TEST(ReadMesh, ReadsObjAsMetresWithZUp) {
  const TemporaryFolder folder;
  const TriangleMesh mesh =
      readMesh(folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 1 0 2\nv 0 0 2\nf 1 2 3 4\n"));
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(boundsOfMesh(mesh).max().isApprox(Eigen::Vector3d(1.0, 0.0, 2.0)));
}

TEST(ReadMesh, FollowsTheUnitAndTheUpAxisOfADaeAndDropsStrayLines) {
  const TemporaryFolder folder;
  for (const char* up_axis : {"Z_UP", "Y_UP"}) {
    for (const double unit_m : {1.0, 0.0254}) {
      const TriangleMesh mesh = readMesh(folder.write("t.dae", triangleDae(up_axis, unit_m)));
      EXPECT_EQ(mesh.triangles.size(), 1u);
      const Eigen::AlignedBox3d bounds = boundsOfMesh(mesh);
      EXPECT_TRUE(bounds.min().isApprox(unit_m * Eigen::Vector3d(1.0, 0.0, 0.0), 1e-5))
          << up_axis << ' ' << unit_m << ": " << bounds.min().transpose();
      EXPECT_TRUE(bounds.max().isApprox(unit_m * Eigen::Vector3d(1.0, 3.0, 2.0), 1e-5))
          << up_axis << ' ' << unit_m << ": " << bounds.max().transpose();
    }
  }
}

TEST(ReadMesh, RefusesWhatIsNoMeshByName) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusalOf(readMesh, folder / "none.stl"), HasSubstr("none.stl: cannot be opened"));
  EXPECT_THAT(refusalOf(readMesh, folder.write("text.dae", "hello")), HasSubstr("text.dae"));
  EXPECT_THAT(refusalOf(readMesh, folder.write("empty.stl", "")), HasSubstr("empty.stl"));
  EXPECT_THAT(refusalOf(readMesh, folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")),
              HasSubstr("no triangles"));
  EXPECT_THAT(refusalOf(readMesh, folder.write("far.stl", boxStl(1e6))), HasSubstr("metres"));
  EXPECT_THAT(
      refusalOf(readMesh, folder.write("nan.obj", "v nan 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")),
      HasSubstr("nan.obj"));
}

TEST(ReadMesh, RefusesAFileThatItsReaderDiesOf) {
  const TemporaryFolder folder;
  std::string text = triangleDae("Z_UP", 1.0);
  text.replace(text.find(" count=\"15\""), 11, "");
  EXPECT_THAT(refusalOf(readMesh, folder.write("t.dae", text)), HasSubstr("t.dae"));
}

TEST(ReadMesh, ReadsOrRefusesDamagedFilesButNeverFailsOtherwise) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> files = {
      {"a.stl", boxStl()},
      {"a.obj", "v 0 0 0\nv 1 0 0\nv 1 0 2\nv 0 0 2\nf 1 2 3 4\n"},
      {"a.dae", triangleDae("Z_UP", 1.0)}};
  int refused = 0;
  for (const auto& [name, text] : files) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
      Random random(seed, Stream::kBuilding);
      std::string damaged = text;
      for (int i = 0; i < 3; ++i) {
        const std::size_t at = random.bits() % damaged.size();
        damaged[at] = static_cast<char>(random.bits() % 256);
      }
      if (seed % 4 == 0) damaged.resize(random.bits() % damaged.size());
      if (refusalOf(readMesh, folder.write(name, damaged)) != "accepted") ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

TEST(MeshWorld, IsSeenAndHitLikeTheSameBox) {
  const TemporaryFolder folder;
  folder.write("box.stl", boxStl());
  const World mesh = readWorld(folder.write(
      "mesh.yaml", "include: [{file: box.stl, position: [3, -0.5, 0], material: wood}]\n"));
  const World box =
      readWorld(folder.write("box.yaml", "boxes: [{center: [4, 0, 0.25], size: [2, 1, 0.5]}]\n"));
  LidarParameters p;
  p.range_sigma_m = 0.0;
  const Lidar lidar(p, 1);
  const SensorPath path{{0}, {Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.1, 0.37))}};
  EXPECT_EQ(lidar.measure(0, 0, path, RayCaster(mesh)).ranges_m,
            lidar.measure(0, 0, path, RayCaster(box)).ranges_m);
  EXPECT_EQ(mesh.materials[mesh.solids[0].material].name, "wood");

  Physics among_triangles(testing::shippedRobot(), mesh, {});
  Physics among_boxes(testing::shippedRobot(), box, {});
  for (int step = 0; step < 6000; ++step) {
    among_triangles.step(1e-3, {10.0, 10.0});
    among_boxes.step(1e-3, {10.0, 10.0});
  }
  EXPECT_TRUE(among_triangles.touchesSolid());
  EXPECT_NEAR(among_triangles.worldFromBase().translation().x(),
              among_boxes.worldFromBase().translation().x(), 0.01);
}

TEST(MeshWorld, IsDrawnAsTheLinesItCutsAtTheHeightOfTheLidar) {
  const TemporaryFolder folder;
  World world = readWorld(folder.write("box.stl", boxStl()));
  world.start = {1.0, 0.5, 0.0};
  const MapImage map = drawMap(world, 0.25, 0.05);
  const auto at = [&map](double x, double y) {
    return map.at(static_cast<int>((x - map.world_from_map.x_m) / 0.05),
                  static_cast<int>((y - map.world_from_map.y_m) / 0.05));
  };
  EXPECT_EQ(at(1.0, 0.5), Cell::kFree);
  EXPECT_EQ(at(1.0, 0.0), Cell::kOccupied);
  EXPECT_EQ(at(2.0, 0.5), Cell::kOccupied);
  EXPECT_EQ(at(2.5, 0.5), Cell::kUnknown);
}

constexpr const char* kUrdf = R"(<robot name="shed">
<link name="base"><collision><origin xyz="1 2 0.5"/><geometry><box size="1 2 1"/></geometry></collision></link>
<joint name="j" type="fixed"><parent link="base"/><child link="post"/><origin xyz="5 0 0" rpy="0 0 1.5707963"/></joint>
<link name="post"><collision><origin xyz="1 0 1"/><geometry><cylinder radius="0.2" length="2"/></geometry></collision>
<collision><geometry><mesh filename="box.stl" scale="2 2 2"/></geometry></collision></link>
</robot>)";

TEST(UrdfWorld, PutsCollisionShapesAtTheEndOfTheirJoints) {
  const TemporaryFolder folder;
  folder.write("box.stl", boxStl());
  const World world = readWorld(folder.write("shed.urdf", kUrdf));
  ASSERT_EQ(world.solids.size(), 3u);
  EXPECT_TRUE(world.solids[0].world_from_solid.translation().isApprox(Eigen::Vector3d(1, 2, 0.5)));
  EXPECT_EQ(world.solids[1].shape, Shape::kCylinder);
  EXPECT_TRUE(
      world.solids[1].world_from_solid.translation().isApprox(Eigen::Vector3d(5, 1, 1), 1e-6));
  EXPECT_TRUE(boundsOf(world.solids[2]).max().isApprox(Eigen::Vector3d(5, 4, 1), 1e-5));
}

TEST(UrdfWorld, RefusesByFileAndElement) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusalOf(readWorld, folder.write("a.urdf", "<robot")), HasSubstr("a.urdf"));
  EXPECT_THAT(refusalOf(readWorld, folder.write("b.urdf", kUrdf)), HasSubstr("box.stl"));
  const std::string flat = R"(<robot name="r"><link name="slab"><collision><geometry>)"
                           R"(<box size="1 0 1"/></geometry></collision></link></robot>)";
  EXPECT_THAT(refusalOf(readWorld, folder.write("c.urdf", flat)), HasSubstr("link 'slab'"));
  EXPECT_THAT(
      refusalOf(readWorld, folder.write("d.urdf", R"(<robot name="r"><link name="l"/></robot>)")),
      HasSubstr("collision"));
}

std::string sdf(const std::string& model) {
  return R"(<?xml version="1.0"?><sdf version="1.6"><world name="w"><light name="sun" type="directional"/>
<model name="m">)" +
         model + "</model></world></sdf>";
}

constexpr const char* kSdfLink = R"(<static>true</static><pose>10 0 0 0 0 1.5707963</pose>
<link name="l"><pose>1 0 0 0 0 0</pose>
<collision name="c"><pose>0 0 0.5 0 0 0</pose><geometry><box><size>1 2 1</size></box></geometry></collision>
<collision name="f"><geometry><plane><normal>0 0 1</normal><size>9 9</size></plane></geometry></collision>
<visual name="v"><geometry><sphere><radius>3</radius></sphere></geometry></visual></link>)";

TEST(SdfWorld, ChainsThePosesOfModelLinkAndCollision) {
  const TemporaryFolder folder;
  const World world = readWorld(folder.write("a.sdf", sdf(kSdfLink)));
  ASSERT_EQ(world.solids.size(), 1u);
  EXPECT_TRUE(
      world.solids[0].world_from_solid.translation().isApprox(Eigen::Vector3d(10, 1, 0.5), 1e-6));
  EXPECT_TRUE(boundsOf(world).sizes().isApprox(Eigen::Vector3d(2, 1, 1), 1e-6));
}

TEST(SdfWorld, FindsMeshesBesideTheModel) {
  const TemporaryFolder folder;
  folder.write("box.stl", boxStl());
  const std::string mesh =
      R"(<static>1</static><link name="l"><collision name="c"><geometry><mesh>)"
      R"(<uri>file://box.stl</uri><scale>2 1 1</scale></mesh></geometry></collision></link>)";
  const World world = readWorld(folder.write("a.sdf", sdf(mesh)));
  EXPECT_TRUE(boundsOf(world).max().isApprox(Eigen::Vector3d(4, 1, 0.5), 1e-6));
}

TEST(SdfWorld, RefusesWhatItCannotDoByLineAndElement) {
  const TemporaryFolder folder;
  const auto refusal = [&folder](const std::string& model) {
    return refusalOf(readWorld, folder.write("a.sdf", sdf(model)));
  };
  const std::string head = "<static>true</static>";
  const auto shaped = [&head](const std::string& shape) {
    return head + "<link name='l'><collision name='c'><geometry>" + shape +
           "</geometry></collision></link>";
  };
  EXPECT_THAT(refusal("<link name='l'/>"), HasSubstr("<model name='m'>: is not static"));
  EXPECT_THAT(refusal(head + "<joint name='hinge'/>"), HasSubstr("line 2: <joint name='hinge'>"));
  EXPECT_THAT(refusal(head + "<include/>"), HasSubstr("<include>: is not supported"));
  EXPECT_THAT(refusal(head + "<pose relative_to='x'>0 0 0 0 0 0</pose>"), HasSubstr("relative"));
  EXPECT_THAT(refusal(head + "<pose>0 0 0</pose>"), HasSubstr("6 numbers"));
  EXPECT_THAT(refusal(head + "<pose>0 0 nan 0 0 0</pose>"), HasSubstr("<pose>"));
  EXPECT_THAT(refusal(shaped("<heightmap/>")), HasSubstr("<heightmap>"));
  EXPECT_THAT(refusal(shaped("<box><size>1 -1 1</size></box>")), HasSubstr("above 0"));
  EXPECT_THAT(refusal(shaped("<sphere/>")), HasSubstr("<radius>"));
  EXPECT_THAT(refusal(shaped("<mesh><uri>model://x/y.dae</uri></mesh>")), HasSubstr("y.dae"));
  EXPECT_THAT(refusal(shaped("<plane><normal>1 0 0</normal></plane>")), HasSubstr("<plane>"));
  EXPECT_THAT(refusal(head), HasSubstr("no collision"));
  EXPECT_THAT(refusalOf(readWorld, folder.write("b.sdf", "<sdf><world>")), HasSubstr("not XML"));
  EXPECT_THAT(refusalOf(readWorld, folder.write("c.sdf", "<robot/>")), HasSubstr("<sdf>"));
}

TEST(ModelWorlds, AreReadOrRefusedWhenDamagedButNeverFailOtherwise) {
  const TemporaryFolder folder;
  folder.write("box.stl", boxStl());
  const std::vector<std::pair<std::string, std::string>> files = {{"a.urdf", kUrdf},
                                                                  {"a.sdf", sdf(kSdfLink)}};
  int refused = 0;
  for (const auto& [name, text] : files) {
    for (std::uint64_t seed = 0; seed < 300; ++seed) {
      Random random(seed, Stream::kBuilding);
      std::string damaged = text;
      for (int i = 0; i < 3; ++i)
        damaged[random.bits() % damaged.size()] = static_cast<char>(random.bits() % 256);
      if (seed % 5 == 0) damaged.resize(random.bits() % damaged.size());
      if (refusalOf(readWorld, folder.write(name, damaged)) != "accepted") ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

}  // namespace
}  // namespace ramscout_sim
