#include "served.hpp"

#include <utility>

namespace belvedere_ros {

Served& Served::here() {
    static Served served;
    return served;
}

Served::Place::Place(std::string topic, Domain& domain, const bv_stream_info& stream) : topic_(std::move(topic)) {
    Served& served = here();
    const std::lock_guard<std::mutex> lock(served.mutex_);
    // Two bridges of one name and domain would serve the same: the first holds.
    const auto [place, is_new] = served.sources_.emplace(topic_, Source{domain, stream});
    if (is_new) served.tell(topic_, &place->second);
}

Served::Place::~Place() {
    Served& served = here();
    const std::lock_guard<std::mutex> lock(served.mutex_);
    served.tell(topic_, nullptr);
    served.sources_.erase(topic_);
}

void Served::seek(const std::string& topic, Seeker& seeker) {
    const std::lock_guard<std::mutex> lock(mutex_);
    seekers_[topic].insert(&seeker);
    if (const auto source = sources_.find(topic); source != sources_.end()) seeker.serve(&source->second);
}

void Served::forget(const std::string& topic, Seeker& seeker) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = seekers_.find(topic);
    if (found == seekers_.end()) return;
    found->second.erase(&seeker);
    if (found->second.empty()) seekers_.erase(found);
}

void Served::tell(const std::string& topic, const Source* source) {
    const auto found = seekers_.find(topic);
    if (found == seekers_.end()) return;
    for (Seeker* seeker : found->second) seeker->serve(source);
}

}  // namespace belvedere_ros
