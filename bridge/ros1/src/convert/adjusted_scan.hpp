// A scan as the parameters of its topic want it.
#pragma once

#include "../scan_parameters.hpp"
#include "header.hpp"

namespace belvedere_ros {

/// Sees the same ranges through a header of its own; as long as the frame lives.
class AdjustedScan {
public:
    /// Throws Unrepresentable when no ray is left, or the scan's times are none.
    AdjustedScan(const Sample& scan, const ScanParameters& parameters);

    Sample sample() const { return {header_, payload_}; }

private:
    void crop(const ScanParameters& parameters);

    belvedere::Header header_;
    belvedere::Span<const std::uint8_t> payload_;
};

}  // namespace belvedere_ros
