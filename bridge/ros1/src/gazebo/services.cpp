#include "services.hpp"

#include <boost/make_shared.hpp>
#include <ros/network.h>
#include <ros/service_manager.h>

#include <exception>

#include "../convert/header.hpp"
#include "empty_service.hpp"

namespace belvedere_ros::gazebo {

namespace {

constexpr std::uint32_t kQueue = 10;  // as Gazebo's
constexpr const char* kFirst = "get_world_properties";
constexpr const char* kStates = "set_model_state";
constexpr double kRestPeriod = 1.0;

void set_pose(bv_simulation_command& command, const geometry_msgs::Pose& pose) {
    const auto& [p, q] = std::tie(pose.position, pose.orientation);
    const double position[] = {p.x, p.y, p.z}, orientation[] = {q.x, q.y, q.z, q.w};
    std::copy(std::begin(position), std::end(position), command.position);
    std::copy(std::begin(orientation), std::end(orientation), command.orientation);
}

void set_twist(bv_simulation_command& command, const geometry_msgs::Twist& twist) {
    const auto& [l, a] = std::tie(twist.linear, twist.angular);
    const double linear[] = {l.x, l.y, l.z}, angular[] = {a.x, a.y, a.z};
    std::copy(std::begin(linear), std::end(linear), command.linear);
    std::copy(std::begin(angular), std::end(angular), command.angular);
}

/// Removes whitespace before an XML declaration, which XML does not allow. Gazebo accepts texts of scripts that begin
/// with an empty line.
std::string to_xml(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t\r\n");
    return begin != std::string::npos && text.compare(begin, 5, "<?xml") == 0 ? text.substr(begin) : text;
}

/// Returns some existing names, for the error about an unknown one.
std::string some_of(const States& states) {
    constexpr std::size_t kSome = 12;
    std::string text;
    const auto names = states.names();
    for (std::size_t index = 0; index < names.size() && index <= kSome; ++index)
        text += (index == 0 ? "" : ", ") + (index == kSome ? "…" : names[index]);
    return text;
}

}  // namespace

Services::Services(const ros::NodeHandle& nh, Domain& domain) : nh_(nh), simulator_(domain), spinner_(1, &queue_) {
    nh_.setCallbackQueue(&queue_);
    serve<gazebo_msgs::GetWorldProperties>(kFirst, "GetWorldProperties", &Services::get_world_properties);
    rest_ = nh_.createWallTimer(ros::WallDuration(kRestPeriod), [this](const ros::WallTimerEvent&) { simulator_.rest(); });
    spinner_.start();
}

void Services::serve_all() {
    serve_empty("pause_physics", BV_OPERATION_PAUSE);
    serve_empty("unpause_physics", BV_OPERATION_RESUME);
    serve_empty("reset_world", BV_OPERATION_RESET_WORLD);
    serve_empty("reset_simulation", BV_OPERATION_RESET_SIMULATION);
    serve<gazebo_msgs::GetModelState>("get_model_state", "GetModelState", &Services::get_model_state);
    serve<gazebo_msgs::GetLinkState>("get_link_state", "GetLinkState", &Services::get_link_state);
    serve<gazebo_msgs::SetModelState>("set_model_state", "SetModelState", &Services::set_model_state);
    serve<gazebo_msgs::SpawnModel>("spawn_sdf_model", "SpawnModel", &Services::spawn_model);
    serve<gazebo_msgs::SpawnModel>("spawn_urdf_model", "SpawnModel", &Services::spawn_model);
    serve<gazebo_msgs::DeleteModel>("delete_model", "DeleteModel", &Services::delete_model);
    const boost::function<void(const gazebo_msgs::ModelStateConstPtr&)> receive = [this](const auto& state) { received(*state); };
    states_ = nh_.subscribe<gazebo_msgs::ModelState>(kStates, kQueue, receive);
}

bool Services::are_ours(std::uint32_t own_port) const {
    if (!servers_.front()) return false;  // another nodelet of this process was the first
    std::string host;
    std::uint32_t port = 0;
    // A master that does not answer has not given it to another node.
    return !ros::ServiceManager::instance()->lookupService(servers_.front().getService(), host, port) ||
           (host == ros::network::getHost() && port == own_port);
}

bool Services::are_at(const ros::NodeHandle& nh) {
    return ros::service::exists(nh.resolveName(kFirst), false);
}

void Services::serve_empty(const std::string& name, bv_operation operation) {
    ros::AdvertiseServiceOptions options;
    options.init<std_srvs::Empty>(name, {});
    options.helper = boost::make_shared<EmptyService>([this, operation] { simulator_.command(command_of(operation)); });
    servers_.push_back(nh_.advertiseService(options));
}

template <class Service>
void Services::serve(const std::string& name, const std::string& speaker,
                     void (Services::*answer)(const typename Service::Request&, typename Service::Response&)) {
    using Request = typename Service::Request;
    using Response = typename Service::Response;
    const boost::function<bool(Request&, Response&)> respond = [this, speaker, answer](Request& request, Response& response) {
        try {
            (this->*answer)(request, response);
            response.success = true;
        } catch (const std::exception& error) {
            response.success = false;
            response.status_message = speaker + ": " + error.what();
        }
        return true;
    };
    servers_.push_back(nh_.advertiseService(name, respond));
}

void Services::get_model_state(const gazebo_msgs::GetModelStateRequest& request, gazebo_msgs::GetModelStateResponse& response) {
    const std::string& reference = request.relative_entity_name;
    const States& models = simulator_.models();
    const bool needs_links = !is_world(reference) && models.find(reference) == nullptr;
    const States* links = needs_links ? &simulator_.models_and_links().links : nullptr;

    const bv_model_state* model = models.find(request.model_name);
    if (model == nullptr) throw Refused("model does not exist: '" + request.model_name + "'; there are: " + some_of(models));
    Motion motion = Motion::of(*model);
    if (!is_world(reference)) {
        const bv_model_state* frame = models.find(reference);
        if (frame == nullptr && links != nullptr) frame = links->find_link(reference);
        if (frame == nullptr)
            throw Refused("reference relative_entity_name not found: '" + reference + "'; name a model, one of its links as model::link, or world");
        motion = motion.relative_to(Motion::of(*frame));
    }
    response.header.seq = ++state_requests_;
    response.header.stamp = to_time(models.stamp_ns);
    response.header.frame_id = reference;
    response.pose = motion.to_pose();
    response.twist = motion.to_twist();
    response.status_message = "GetModelState: got properties";
}

void Services::get_link_state(const gazebo_msgs::GetLinkStateRequest& request, gazebo_msgs::GetLinkStateResponse& response) {
    const auto [models, links] = simulator_.models_and_links();
    const bv_model_state* link = links.find_link(request.link_name);
    if (link == nullptr) throw Refused("link not found: '" + request.link_name + "'; name it as model::link; there are: " + some_of(links));
    Motion motion = Motion::of(*link);
    if (!is_world(request.reference_frame)) {
        const bv_model_state* frame = models.find(request.reference_frame);
        if (frame == nullptr) frame = links.find_link(request.reference_frame);
        if (frame == nullptr)
            throw Refused("reference_frame not found: '" + request.reference_frame + "'; name a model, one of its links as model::link, or world");
        motion = motion.relative_to(Motion::of(*frame));
    }
    response.link_state.link_name = request.link_name;
    response.link_state.pose = motion.to_pose();
    response.link_state.twist = motion.to_twist();
    response.link_state.reference_frame = request.reference_frame;
    response.status_message = "GetLinkState: got state";
}

void Services::get_world_properties(const gazebo_msgs::GetWorldPropertiesRequest&, gazebo_msgs::GetWorldPropertiesResponse& response) {
    const States& models = simulator_.models();
    response.sim_time = static_cast<double>(models.stamp_ns) * 1e-9;
    response.model_names = models.names();
    response.rendering_enabled = true;
    response.status_message = "GetWorldProperties: got properties";
}

void Services::set_model_state(const gazebo_msgs::SetModelStateRequest& request, gazebo_msgs::SetModelStateResponse& response) {
    move(request.model_state);
    response.status_message = "SetModelState: set model state done";
}

void Services::spawn_model(const gazebo_msgs::SpawnModelRequest& request, gazebo_msgs::SpawnModelResponse& response) {
    bv_simulation_command command = command_of(BV_OPERATION_SPAWN);
    set_name(command.name, request.model_name);
    set_name(command.reference, request.reference_frame);
    set_name(command.robot_namespace, request.robot_namespace);
    set_pose(command, request.initial_pose);
    simulator_.command(command, to_xml(request.model_xml));
    response.status_message = "SpawnModel: Successfully spawned entity";
}

void Services::delete_model(const gazebo_msgs::DeleteModelRequest& request, gazebo_msgs::DeleteModelResponse& response) {
    bv_simulation_command command = command_of(BV_OPERATION_DELETE);
    set_name(command.name, request.model_name);
    simulator_.command(command);
    response.status_message = "DeleteModel: successfully deleted model";
}

void Services::move(const gazebo_msgs::ModelState& state) {
    bv_simulation_command command = command_of(BV_OPERATION_SET_MODEL_STATE);
    set_name(command.name, state.model_name);
    set_name(command.reference, state.reference_frame);
    set_pose(command, state.pose);
    set_twist(command, state.twist);
    simulator_.command(command);
}

void Services::received(const gazebo_msgs::ModelState& state) {
    try {
        move(state);
    } catch (const std::exception& error) {
        if (trouble_.due()) ROS_WARN_STREAM(nh_.resolveName(kStates) << ": " << error.what());
    }
}

}  // namespace belvedere_ros::gazebo
