#pragma once
/* The functions of Force Dimension's DRD that programs know: names and signatures, as documented. No file of theirs is
   here. `char` is the number of a device, -1: the default one. Private to this module and its tests. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

int drdAutoInit(char);
int drdCheckInit(char);
int drdClose(char);
int drdEnableFilter(unsigned char, char);
double drdGetCtrlFreq(char);
int drdGetDeviceID(void);
double drdGetEncDGain(char);
double drdGetEncIGain(char);
int drdGetEncMoveParam(double*, double*, double*, char);
double drdGetEncPGain(char);
int drdGetEncTrackParam(double*, double*, double*, char);
int drdGetGripMoveParam(double*, double*, double*, char);
int drdGetGripTrackParam(double*, double*, double*, char);
double drdGetMotRatioMax(char);
int drdGetPosMoveParam(double*, double*, double*, char);
int drdGetPosTrackParam(double*, double*, double*, char);
int drdGetPositionAndOrientation(double*, double*, double*, double*, double*, double*, double*, double*,
                                 char);
int drdGetPriorities(int*, int*, char);
int drdGetRotMoveParam(double*, double*, double*, char);
int drdGetRotTrackParam(double*, double*, double*, char);
int drdGetVelocity(double*, double*, double*, double*, double*, double*, double*, char);
int drdHold(char);
bool drdIsFiltering(char);
bool drdIsInitialized(char);
bool drdIsMoving(char);
bool drdIsRunning(char);
bool drdIsSupported(char);
int drdLock(unsigned char, unsigned char, char);
int drdMoveTo(double*, unsigned char, char);
int drdMoveToAllEnc(int*, unsigned char, char);
int drdMoveToEnc(int, int, int, unsigned char, char);
int drdMoveToGrip(double, unsigned char, char);
int drdMoveToPos(double, double, double, unsigned char, char);
int drdMoveToRot(double, double, double, unsigned char, char);
int drdOpen(void);
int drdOpenID(char);
int drdPrecisionInit(char);
int drdRegulateGrip(unsigned char, char);
int drdRegulatePos(unsigned char, char);
int drdRegulateRot(unsigned char, char);
int drdSetDevice(char);
int drdSetEncDGain(double, char);
int drdSetEncIGain(double, char);
int drdSetEncMoveParam(double, double, double, char);
int drdSetEncPGain(double, char);
int drdSetEncTrackParam(double, double, double, char);
int drdSetForceAndTorqueAndGripperForce(double, double, double, double, double, double, double, char);
int drdSetForceAndWristJointTorquesAndGripperForce(double, double, double, double, double, double, double,
                                                   char);
int drdSetGripMoveParam(double, double, double, char);
int drdSetGripTrackParam(double, double, double, char);
int drdSetMotRatioMax(double, char);
int drdSetPosMoveParam(double, double, double, char);
int drdSetPosTrackParam(double, double, double, char);
int drdSetPriorities(int, int, char);
int drdSetRotMoveParam(double, double, double, char);
int drdSetRotTrackParam(double, double, double, char);
int drdStart(char);
int drdStop(unsigned char, char);
int drdTrack(double*, char);
int drdTrackAllEnc(int*, char);
int drdTrackEnc(int, int, int, char);
int drdTrackGrip(double, char);
int drdTrackPos(double, double, double, char);
int drdTrackRot(double, double, double, char);
void drdWaitForTick(char);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
