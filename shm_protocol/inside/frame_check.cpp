#include "shm_protocol/inside/frame_check.hpp"

#include <string>

namespace wade::shm {
namespace {

[[noreturn]] void refuse(const StreamInfo& info, std::uint64_t frame, const std::string& why) {
    throw Error(Failure::protocol_violation,
                "Frame " + std::to_string(frame) + " from '" + info.producer_name + "' " + why + ".");
}

}  // namespace

void check_count(const StreamInfo& info, std::uint64_t frame, std::uint32_t count) {
    if (count > info.capacity)
        refuse(info, frame,
               "holds " + std::to_string(count) + " particles, the capacity is " + std::to_string(info.capacity));
}

Frame checked_frame(const StreamInfo& info, std::uint64_t frame, const SlotDescriptor& d, FieldSpans fields,
                    FrameHistory& history) {
    if (history.last_tick && d.tick <= *history.last_tick)
        refuse(
            info, frame,
            "has tick " + std::to_string(d.tick) + ", the frame before it has " + std::to_string(*history.last_tick));
    const ChainResult result =
        history.check_values ? chain_frame(history.chain, frame, fields) : ChainResult{d.hash, false};
    if (d.hash != 0 && d.hash != result.hash)
        refuse(info, frame,
               "does not match its hash: it was changed after it was published, or its chain is another one");
    if (result.nonfinite) {
        for (std::size_t i = 0; i < fields.size(); ++i)
            if (const std::size_t k = first_nonfinite(fields[i]); k < fields[i].size())
                refuse(info, frame,
                       "holds non-finite values (first: particle " + std::to_string(k) + ", field " +
                           required_fields(info.kind)[i] + ")");
    }
    if ((d.flags & frame_nonfinite) != 0) refuse(info, frame, "is marked by its producer as holding non-finite values");
    history.chain = result.hash;
    history.last_tick = d.tick;

    Frame out;
    out.frame = frame;
    out.tick = d.tick;
    out.count = d.count;
    out.final = (d.flags & frame_final) != 0;
    out.hash = result.hash;
    out.mass = fields[0];
    out.vx = fields[1];
    out.vy = fields[2];
    out.vz = fields[3];
    out.px = fields[4];
    out.py = fields[5];
    out.pz = fields[6];
    if (info.kind == stream_agents) {
        out.radius = fields[7];
        out.height = fields[8];
        out.state = fields[9];
    }
    out.diagnostics = d.diagnostics;
    return out;
}

}  // namespace wade::shm
