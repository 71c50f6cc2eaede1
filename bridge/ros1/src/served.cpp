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
    std::list<Source>& sources = served.sources_[topic_];
    source_ = sources.insert(sources.end(), Source{domain, stream});
    if (sources.size() == 1) served.tell(topic_, &*source_);
}

Served::Place::~Place() {
    Served& served = here();
    const std::lock_guard<std::mutex> lock(served.mutex_);
    const auto found = served.sources_.find(topic_);
    std::list<Source>& sources = found->second;
    const bool held = source_ == sources.begin();
    const auto next = sources.erase(source_);
    if (held) served.tell(topic_, sources.empty() ? nullptr : &*next);
    if (sources.empty()) served.sources_.erase(found);
}

void Served::seek(const std::string& topic, Seeker& seeker) {
    const std::lock_guard<std::mutex> lock(mutex_);
    seekers_[topic].insert(&seeker);
    if (const auto source = sources_.find(topic); source != sources_.end()) seeker.serve(&source->second.front());
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
