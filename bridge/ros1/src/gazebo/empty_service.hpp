// A service without fields that can say why it has failed.
#pragma once

#include <ros/service_callback_helper.h>
#include <ros/serialization.h>
#include <std_srvs/Empty.h>

#include <exception>
#include <functional>
#include <string>
#include <utility>

namespace belvedere_ros::gazebo {

/// std_srvs/Empty. What its function throws is what the caller's error says: roscpp's own way, a callback that gives false,
/// has no words.
class EmptyService : public ros::ServiceCallbackHelper {
public:
    explicit EmptyService(std::function<void()> act) : act_(std::move(act)) {}

    bool call(ros::ServiceCallbackHelperCallParams& params) override {
        try {
            act_();
            params.response = ros::serialization::serializeServiceResponse(true, std_srvs::EmptyResponse());
        } catch (const std::exception& error) {
            params.response = ros::serialization::serializeServiceResponse(false, std::string(error.what()));
        }
        return true;  // there is an answer
    }

private:
    std::function<void()> act_;
};

}  // namespace belvedere_ros::gazebo
