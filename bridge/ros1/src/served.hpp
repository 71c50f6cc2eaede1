// The topics that the bridges of this process serve, for subscribers to frames instead of messages.
#pragma once

#include <belvedere.hpp>

#include <list>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "domain.hpp"

namespace belvedere_ros {

/// A stream and its domain.
struct Source {
    Domain& domain;
    bv_stream_info stream;
};

/// A registry that connects servers of topics with seekers, in whichever order they register.
class Served {
public:
    /// A client that waits for a topic.
    class Seeker {
    public:
        virtual ~Seeker() = default;
        /// Receives the current source of the topic; null if it is no longer served and about to be destroyed.
        virtual void serve(const Source* source) = 0;
    };

    /// A registration of a served topic, for the lifetime of this object. If several bridges serve one topic, as
    /// nodelets of one manager may, the first registration applies; when it ends, the next one does.
    class Place {
    public:
        Place(std::string topic, Domain& domain, const bv_stream_info& stream);
        ~Place();
        Place(const Place&) = delete;
        Place& operator=(const Place&) = delete;

    private:
        const std::string topic_;
        std::list<Source>::iterator source_;
    };

    static Served& here();

    /// Registers a seeker, and notifies it at once if the topic is served.
    void seek(const std::string& topic, Seeker& seeker);
    /// Removes a seeker, which receives no further notifications, not even of the end of the topic.
    void forget(const std::string& topic, Seeker& seeker);

private:
    void tell(const std::string& topic, const Source* source);

    std::mutex mutex_;
    /// Keyed by topic; the first source of each applies.
    std::map<std::string, std::list<Source>> sources_;
    std::map<std::string, std::set<Seeker*>> seekers_;
};

}  // namespace belvedere_ros
