// The robotic half of the interface: forces, and where the hand is (dhd_read.cpp), work as by dhd*. Its regulation, a position loop in
// the program's process, is never started.

#include "drd.h"

#include "dhd.h"
#include "dhd_state.hpp"

namespace {

using namespace knurl::lookalike::dhd;

/// What only a running regulation does.
int no_regulation(const char* function) {
    knurl::lookalike::say_once(std::string(function) + ": no regulation runs; drdStart is not available");
    return fail(Code::no_regulation);
}

}  // namespace

extern "C" {

int drdOpen(void) {
    return dhdOpen();
}
int drdOpenID(char id) {
    return dhdOpenID(id);
}
int drdSetDevice(char id) {
    return dhdSetDevice(id);
}
int drdGetDeviceID(void) {
    return dhdGetDeviceID();
}
int drdClose(char id) {
    return dhdClose(id);
}
bool drdIsSupported(char) {
    return false;
}
bool drdIsRunning(char) {
    return false;
}
bool drdIsMoving(char) {
    return false;
}
bool drdIsFiltering(char) {
    return false;
}
bool drdIsInitialized(char id) {
    return call([=] { return report(id).state != knurl::DeviceState::disconnected; }, false);
}
int drdAutoInit(char id) {
    return dhdWaitForReset(0, id);  // Knurl's drivers calibrate
}
int drdCheckInit(char id) {
    return dhdWaitForReset(0, id);
}
int drdSetForceAndTorqueAndGripperForce(double x, double y, double z, double a, double b, double c,
                                        double gripper, char id) {
    return dhdSetForceAndTorqueAndGripperForce(x, y, z, a, b, c, gripper, id);
}
double drdGetCtrlFreq(char) {
    return 0;
}
void drdWaitForTick(char id) {
    call([=] { return opened(id)->hand.pace(), 0; });
}
int drdStop(unsigned char force_on, char id) {
    return force_on != 0 ? call([=] { return opened(id), 0; }) : dhdStop(id);
}

int drdEnableFilter(unsigned char, char) {
    return no_regulation("drdEnableFilter");
}
int drdGetEncMoveParam(double*, double*, double*, char) {
    return no_regulation("drdGetEncMoveParam");
}
int drdGetEncTrackParam(double*, double*, double*, char) {
    return no_regulation("drdGetEncTrackParam");
}
int drdGetGripMoveParam(double*, double*, double*, char) {
    return no_regulation("drdGetGripMoveParam");
}
int drdGetGripTrackParam(double*, double*, double*, char) {
    return no_regulation("drdGetGripTrackParam");
}
int drdGetPosMoveParam(double*, double*, double*, char) {
    return no_regulation("drdGetPosMoveParam");
}
int drdGetPosTrackParam(double*, double*, double*, char) {
    return no_regulation("drdGetPosTrackParam");
}
int drdGetRotMoveParam(double*, double*, double*, char) {
    return no_regulation("drdGetRotMoveParam");
}
int drdGetRotTrackParam(double*, double*, double*, char) {
    return no_regulation("drdGetRotTrackParam");
}
int drdHold(char) {
    return no_regulation("drdHold");
}
int drdLock(unsigned char, unsigned char, char) {
    return no_regulation("drdLock");
}
int drdMoveTo(double*, unsigned char, char) {
    return no_regulation("drdMoveTo");
}
int drdMoveToAllEnc(int*, unsigned char, char) {
    return no_regulation("drdMoveToAllEnc");
}
int drdMoveToEnc(int, int, int, unsigned char, char) {
    return no_regulation("drdMoveToEnc");
}
int drdMoveToGrip(double, unsigned char, char) {
    return no_regulation("drdMoveToGrip");
}
int drdMoveToPos(double, double, double, unsigned char, char) {
    return no_regulation("drdMoveToPos");
}
int drdMoveToRot(double, double, double, unsigned char, char) {
    return no_regulation("drdMoveToRot");
}
int drdRegulateGrip(unsigned char, char) {
    return no_regulation("drdRegulateGrip");
}
int drdRegulatePos(unsigned char, char) {
    return no_regulation("drdRegulatePos");
}
int drdRegulateRot(unsigned char, char) {
    return no_regulation("drdRegulateRot");
}
int drdSetEncDGain(double, char) {
    return no_regulation("drdSetEncDGain");
}
int drdSetEncIGain(double, char) {
    return no_regulation("drdSetEncIGain");
}
int drdSetEncMoveParam(double, double, double, char) {
    return no_regulation("drdSetEncMoveParam");
}
int drdSetEncPGain(double, char) {
    return no_regulation("drdSetEncPGain");
}
int drdSetEncTrackParam(double, double, double, char) {
    return no_regulation("drdSetEncTrackParam");
}
int drdSetGripMoveParam(double, double, double, char) {
    return no_regulation("drdSetGripMoveParam");
}
int drdSetGripTrackParam(double, double, double, char) {
    return no_regulation("drdSetGripTrackParam");
}
int drdSetMotRatioMax(double, char) {
    return no_regulation("drdSetMotRatioMax");
}
int drdSetPosMoveParam(double, double, double, char) {
    return no_regulation("drdSetPosMoveParam");
}
int drdSetPosTrackParam(double, double, double, char) {
    return no_regulation("drdSetPosTrackParam");
}
int drdSetRotMoveParam(double, double, double, char) {
    return no_regulation("drdSetRotMoveParam");
}
int drdSetRotTrackParam(double, double, double, char) {
    return no_regulation("drdSetRotTrackParam");
}
int drdTrack(double*, char) {
    return no_regulation("drdTrack");
}
int drdTrackAllEnc(int*, char) {
    return no_regulation("drdTrackAllEnc");
}
int drdTrackEnc(int, int, int, char) {
    return no_regulation("drdTrackEnc");
}
int drdTrackGrip(double, char) {
    return no_regulation("drdTrackGrip");
}
int drdTrackPos(double, double, double, char) {
    return no_regulation("drdTrackPos");
}
int drdTrackRot(double, double, double, char) {
    return no_regulation("drdTrackRot");
}
double drdGetEncDGain(char) {
    return not_available("drdGetEncDGain");
}
double drdGetEncIGain(char) {
    return not_available("drdGetEncIGain");
}
double drdGetEncPGain(char) {
    return not_available("drdGetEncPGain");
}
double drdGetMotRatioMax(char) {
    return not_available("drdGetMotRatioMax");
}
int drdGetPriorities(int*, int*, char) {
    return not_available("drdGetPriorities");
}
int drdPrecisionInit(char) {
    return not_available("drdPrecisionInit");
}
int drdSetForceAndWristJointTorquesAndGripperForce(double, double, double, double, double, double, double,
                                                   char) {
    return not_available("drdSetForceAndWristJointTorquesAndGripperForce");
}
int drdSetPriorities(int, int, char) {
    return not_available("drdSetPriorities");
}
int drdStart(char) {
    return not_available("drdStart");
}

}  // extern "C"
