// Prints where each link is: for worlds and models of SDF by the frame graph of libsdformat, for URDF by urdfdom's tree.
// A line is the link's name, its position, and its rotation as x y z w.
//
//     link_poses [-m FOLDER] FILE...     FOLDER has the models of model://
#include <urdf_parser/urdf_parser.h>

#include <cstdio>
#include <cstdlib>
#include <ignition/math/Pose3.hh>
#include <iostream>
#include <sdf/sdf.hh>
#include <string>

using Pose = ignition::math::Pose3d;

static void print(const std::string &name, const Pose &pose) {
  const auto &p = pose.Pos();
  const auto &q = pose.Rot();
  std::printf("%s %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", name.c_str(), p.X(), p.Y(), p.Z(), q.X(), q.Y(),
              q.Z(), q.W());
}

static bool is_wrong(const sdf::Errors &errors) {
  for (const auto &error : errors) std::cerr << error << "\n";
  return !errors.empty();
}

// The pose of a model in a saved <state>, which Gazebo applies and libsdformat only reads.
static bool is_saved(const sdf::World &world, const std::string &model, Pose &pose) {
  if (!world.Element()->HasElement("state")) return false;
  const auto state = world.Element()->GetElement("state");
  for (auto saved = state->FindElement("model"); saved; saved = saved->GetNextElement("model")) {
    if (saved->Get<std::string>("name") == model) {
      pose = saved->Get<Pose>("pose");
      return true;
    }
  }
  return false;
}

// The parts of a model that is placed at `outer`.
static bool walk(const sdf::Model &model, const Pose &outer, const std::string &prefix,
                 const sdf::World *world = nullptr) {
  Pose own;
  if (is_wrong(model.SemanticPose().Resolve(own))) return false;
  if (world != nullptr) is_saved(*world, model.Name(), own);
  const Pose at = outer * own;
  const std::string name = prefix + model.Name() + "::";
  for (uint64_t i = 0; i < model.LinkCount(); i++) {
    Pose link;
    if (is_wrong(model.LinkByIndex(i)->SemanticPose().Resolve(link))) return false;
    print(name + model.LinkByIndex(i)->Name(), at * link);
  }
  for (uint64_t i = 0; i < model.ModelCount(); i++) {
    if (!walk(*model.ModelByIndex(i), at, name)) return false;
  }
  return true;
}

static bool read_sdf(const std::string &file) {
  sdf::Root root;
  const sdf::Errors errors = root.Load(file);
  if (root.Model() == nullptr && root.WorldCount() == 0) return !is_wrong(errors);
  if (is_wrong(errors)) return false;
  if (root.Model() != nullptr) return walk(*root.Model(), Pose(), "");
  const sdf::World *world = root.WorldByIndex(0);
  for (uint64_t i = 0; i < world->ModelCount(); i++) {
    if (!walk(*world->ModelByIndex(i), Pose(), "", world)) return false;
  }
  return true;
}

static void walk(const urdf::Link &link, const Pose &at, const std::string &robot) {
  print(robot + "::" + link.name, at);
  for (const auto &joint : link.child_joints) {
    const urdf::Pose &pose = joint->parent_to_joint_origin_transform;
    double x, y, z, w;
    pose.rotation.getQuaternion(x, y, z, w);
    const Pose inner(ignition::math::Vector3d(pose.position.x, pose.position.y, pose.position.z),
                     ignition::math::Quaterniond(w, x, y, z));
    for (const auto &child : link.child_links) {
      if (child->name == joint->child_link_name) walk(*child, at * inner, robot);
    }
  }
}

int main(int argc, char **argv) {
  bool is_good = true;
  for (int i = 1; i < argc; i++) {
    const std::string file = argv[i];
    if (file == "-m" && i + 1 < argc) {
      sdf::addURIPath("model://", argv[++i]);
      continue;
    }
    std::printf("FILE %s\n", file.c_str());
    if (file.size() > 5 && file.substr(file.size() - 5) == ".urdf") {
      const auto robot = urdf::parseURDFFile(file);
      if (robot && robot->getRoot()) {
        walk(*robot->getRoot(), Pose(), robot->getName());
      } else {
        is_good = false;
      }
    } else {
      is_good = read_sdf(file) && is_good;
    }
  }
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
}
