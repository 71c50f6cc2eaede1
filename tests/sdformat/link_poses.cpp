// Prints where each link is: for worlds and models of SDF by the frame graph of libsdformat, for URDF by urdfdom's tree.
// A line is the link's name, its position, and its rotation as x y z w. `MODEL>LINK` is the canonical link of a model, and
// `MODEL::JOINT[PARENT>CHILD]` a joint: its position, and a quarter turn about its axis. `REFUSED` and `WARNED` follow if
// a file is wrong or doubtful.
//
//     link_poses [-m FOLDER] FILE...     FOLDER has the models of model://
#include <urdf_parser/urdf_parser.h>

#include <cstdio>
#include <cstdlib>
#include <ignition/math/Pose3.hh>
#include <iostream>
#include <sdf/sdf.hh>
#include <sstream>
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

// A joint. One that fixes a link to the world is left out, since Belvedere has no joint for it.
static bool show(const sdf::Joint &joint, const Pose &model, const std::string &prefix) {
  std::string parent, child;
  if (is_wrong(joint.ResolveParentLink(parent)) || is_wrong(joint.ResolveChildLink(child))) return false;
  if (parent == "world" && joint.Type() == sdf::JointType::FIXED) return true;
  Pose at;
  if (is_wrong(joint.SemanticPose().Resolve(at, "__model__"))) return false;
  ignition::math::Vector3d axis = at.Rot() * ignition::math::Vector3d::UnitZ;
  if (joint.Axis() != nullptr && is_wrong(joint.Axis()->ResolveXyz(axis, "__model__"))) return false;
  axis = model.Rot() * axis.Normalized();
  const Pose quarter((model * at).Pos(), ignition::math::Quaterniond(axis, IGN_PI / 2));
  print(prefix + joint.Name() + "[" + (parent == "world" ? parent : prefix + parent) + ">" + prefix + child + "]", quarter);
  return true;
}

// The parts of a model that is placed at `outer`.
static bool walk(const sdf::Model &model, const Pose &outer, const std::string &prefix,
                 const sdf::World *world = nullptr) {
  Pose own;
  if (is_wrong(model.SemanticPose().Resolve(own))) return false;
  if (world != nullptr) is_saved(*world, model.Name(), own);
  const Pose at = outer * own;
  const std::string name = prefix + model.Name() + "::";
  if (prefix.empty() && model.CanonicalLinkAndRelativeName().first != nullptr) {
    print(model.Name() + ">" + model.CanonicalLinkAndRelativeName().second, Pose());
  }
  for (uint64_t i = 0; i < model.LinkCount(); i++) {
    Pose link;
    if (is_wrong(model.LinkByIndex(i)->SemanticPose().Resolve(link))) return false;
    print(name + model.LinkByIndex(i)->Name(), at * link);
  }
  for (uint64_t i = 0; i < model.JointCount(); i++) {
    if (!show(*model.JointByIndex(i), at, name)) return false;
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

static bool read(const std::string &file) {
  if (file.size() <= 5 || file.substr(file.size() - 5) != ".urdf") return read_sdf(file);
  const auto robot = urdf::parseURDFFile(file);
  if (!robot || !robot->getRoot()) return false;
  walk(*robot->getRoot(), Pose(), robot->getName());
  return true;
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
    // libsdformat writes its warnings to the standard error.
    std::ostringstream said;
    std::streambuf *const before = std::cerr.rdbuf(said.rdbuf());
    const bool is_read = read(file);
    std::cerr.rdbuf(before);
    std::cerr << said.str();
    if (!is_read || !said.str().empty()) {
      std::string first = said.str();
      for (char &letter : first) letter = letter == '\n' ? ' ' : letter;
      std::printf("%s %s\n", is_read ? "WARNED" : "REFUSED", first.c_str());
    }
    is_good = is_read && is_good;
  }
  return is_good ? EXIT_SUCCESS : EXIT_FAILURE;
}
