// The topics that the bridges of this process serve, for whoever wants their frames rather than their messages.
#pragma once

#include <belvedere.hpp>

#include <list>
#include <map>
#include <mutex>
#include <set>
#include <string>

#include "domain.hpp"

namespace belvedere_ros {

/// A stream, and where it is.
struct Source {
    Domain& domain;
    bv_stream_info stream;
};

/// Brings together those who serve topics and those who look for them, in whichever order they come.
class Served {
public:
    /// Who looks for a topic.
    class Seeker {
    public:
        virtual ~Seeker() = default;
        /// The source of the topic now; null when it is served no more, and is about to go.
        virtual void serve(const Source* source) = 0;
    };

    /// As long as this lives, the topic is served. Of several bridges that serve one topic, as nodelets of one manager may,
    /// the first holds; when it ends, the next.
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

    /// The seeker is told at once if the topic is served.
    void seek(const std::string& topic, Seeker& seeker);
    /// It is told nothing afterwards, not even that the topic is gone.
    void forget(const std::string& topic, Seeker& seeker);

private:
    void tell(const std::string& topic, const Source* source);

    std::mutex mutex_;
    /// By topic; the first of each holds.
    std::map<std::string, std::list<Source>> sources_;
    std::map<std::string, std::set<Seeker*>> seekers_;
};

}  // namespace belvedere_ros
