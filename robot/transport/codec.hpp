// Between our messages and what goes over the wire. Decoding is total: a code that this build does not know
// becomes the value that allows least.
#pragma once

#include <bus.h>  // generated from robot/msg/bus.idl

#include "robot/msg/drive_request.hpp"
#include "robot/msg/live.hpp"
#include "robot/msg/measurement.hpp"
#include "robot/msg/permit.hpp"

namespace biopsy::transport {

void encode(const Measurement& from, biopsy_wire_Measurement& to);
void encode(const DriveRequest& from, biopsy_wire_DriveRequest& to);
void encode(const Permit& from, biopsy_wire_Permit& to);
void encode(const Decision& from, biopsy_wire_Decision& to);
void encode(const OperatorAct& from, biopsy_wire_OperatorAct& to);
// `to` borrows the bytes of `from`.
void encode(const SealedPlan& from, biopsy_wire_SealedPlan& to);
void encode(const DepthVerdictNote& from, biopsy_wire_DepthVerdict& to);
void encode(const LogHealth& from, biopsy_wire_LogHealth& to);
void encode(const StageTruth& from, biopsy_wire_StageTruth& to);
void encode(const Health& from, biopsy_wire_Health& to);

void decode(const biopsy_wire_Measurement& from, Measurement& to);
void decode(const biopsy_wire_DriveRequest& from, DriveRequest& to);
void decode(const biopsy_wire_Permit& from, Permit& to);
void decode(const biopsy_wire_Decision& from, Decision& to);
void decode(const biopsy_wire_OperatorAct& from, OperatorAct& to);
void decode(const biopsy_wire_SealedPlan& from, SealedPlan& to);
void decode(const biopsy_wire_DepthVerdict& from, DepthVerdictNote& to);
void decode(const biopsy_wire_LogHealth& from, LogHealth& to);
void decode(const biopsy_wire_StageTruth& from, StageTruth& to);
void decode(const biopsy_wire_Health& from, Health& to);

}  // namespace biopsy::transport
