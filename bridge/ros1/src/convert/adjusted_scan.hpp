// A scan adjusted by the parameters of its topic.
#pragma once

#include "../scan_parameters.hpp"
#include "header.hpp"

namespace belvedere_ros {

/// The same ranges with an adjusted header; valid as long as the frame lives.
class AdjustedScan {
public:
    /// Adjusts the scan. Throws Unrepresentable if no ray remains, or if the times of the scan are invalid.
    AdjustedScan(const Sample& scan, const ScanParameters& parameters);

    Sample sample() const { return {header_, payload_}; }

private:
    void crop(const ScanParameters& parameters);

    belvedere::Header header_;
    belvedere::Span<const std::uint8_t> payload_;
};

}  // namespace belvedere_ros
