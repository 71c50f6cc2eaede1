// A service without fields that can report the reason of a failure.
#pragma once

#include <ros/service_callback_helper.h>
#include <ros/serialization.h>
#include <std_srvs/Empty.h>

#include <exception>
#include <functional>
#include <string>
#include <utility>

namespace belvedere_ros::gazebo {

/// A std_srvs/Empty service. The message of an exception of its function becomes the caller's error. roscpp's usual
/// callback, which returns false, cannot report a reason.
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
        return true;  // the answer is written
    }

private:
    std::function<void()> act_;
};

}  // namespace belvedere_ros::gazebo
