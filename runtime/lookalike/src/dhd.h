#pragma once
/* The functions of Force Dimension's DHD that programs know: names and signatures, as documented. No file of theirs is
   here. `char` is the number of a device, -1: the default one. Private to this module and its tests. */

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#pragma GCC visibility push(default)

int dhdCheckControllerMemory(char);
int dhdClose(char);
int dhdConfigAngularVelocity(int, int, char);
int dhdConfigGripperVelocity(int, int, char);
int dhdConfigLinearVelocity(int, int, char);
int dhdControllerSetDevice(int, char);
int dhdDeltaEncoderToPosition(int, int, int, double*, double*, double*, char);
int dhdDeltaEncodersToJointAngles(int, int, int, double*, double*, double*, char);
int dhdDeltaForceToMotor(double, double, double, int, int, int, unsigned short*, unsigned short*,
                         unsigned short*, char);
int dhdDeltaGravityJointTorques(double, double, double, double*, double*, double*, char);
int dhdDeltaJointAnglesToEncoders(double, double, double, int*, int*, int*, char);
int dhdDeltaJointAnglesToJacobian(double, double, double, double*, char);
int dhdDeltaJointTorquesExtrema(double, double, double, double*, double*, char);
int dhdDeltaMotorToForce(unsigned short, unsigned short, unsigned short, int, int, int, double*, double*,
                         double*, char);
int dhdDeltaPositionToEncoder(double, double, double, int*, int*, int*, char);
int dhdDisableExpertMode(void);
int dhdEmulateButton(unsigned char, char);
int dhdEnableExpertMode(void);
int dhdEnableForce(unsigned char, char);
int dhdEnableGripperForce(unsigned char, char);
void dhdEnableSimulator(unsigned char);
int dhdErrorGetLast(void);
const char* dhdErrorGetLastStr(void);
const char* dhdErrorGetStr(int);
int dhdGetAngularVelocityDeg(double*, double*, double*, char);
int dhdGetAngularVelocityRad(double*, double*, double*, char);
int dhdGetAvailableCount(void);
int dhdGetBaseAngleXDeg(double*, char);
int dhdGetBaseAngleXRad(double*, char);
int dhdGetBaseAngleZDeg(double*, char);
int dhdGetBaseAngleZRad(double*, char);
int dhdGetButton(int, char);
unsigned dhdGetButtonMask(char);
double dhdGetComFreq(char);
int dhdGetComMode(char);
int dhdGetComponentVersionStr(uint32_t, char*, size_t, char);
int dhdGetDeltaEncoders(int*, int*, int*, char);
int dhdGetDeltaJacobian(double*, char);
int dhdGetDeltaJointAngles(double*, double*, double*, char);
int dhdGetDeviceAngleDeg(double*, char);
int dhdGetDeviceAngleRad(double*, char);
int dhdGetDeviceCount(void);
int dhdGetDeviceID(void);
int dhdGetEffectorMass(double*, char);
int dhdGetEnc(int*, unsigned char, char);
int dhdGetEncRange(int*, int*, char);
int dhdGetEncVelocities(double*, char);
int dhdGetEncoder(int, char);
int dhdGetForce(double*, double*, double*, char);
int dhdGetForceAndTorque(double*, double*, double*, double*, double*, double*, char);
int dhdGetForceAndTorqueAndGripperForce(double*, double*, double*, double*, double*, double*, double*, char);
int dhdGetGripperAngleDeg(double*, char);
int dhdGetGripperAngleRad(double*, char);
int dhdGetGripperAngularVelocityDeg(double*, char);
int dhdGetGripperAngularVelocityRad(double*, char);
int dhdGetGripperEncoder(int*, char);
int dhdGetGripperFingerPos(double*, double*, double*, char);
int dhdGetGripperGap(double*, char);
int dhdGetGripperLinearVelocity(double*, char);
int dhdGetGripperThumbPos(double*, double*, double*, char);
int dhdGetJointAngleRange(double*, double*, char);
int dhdGetJointAngles(double*, char);
int dhdGetJointVelocities(double*, char);
int dhdGetLinearVelocity(double*, double*, double*, char);
double dhdGetMaxForce(char);
double dhdGetMaxGripperForce(char);
double dhdGetMaxTorque(char);
int dhdGetOrientationDeg(double*, double*, double*, char);
int dhdGetOrientationFrame(double*, char);
int dhdGetOrientationRad(double*, double*, double*, char);
int dhdGetPosition(double*, double*, double*, char);
int dhdGetPositionAndOrientationDeg(double*, double*, double*, double*, double*, double*, char);
int dhdGetPositionAndOrientationFrame(double*, double*, double*, double*, char);
int dhdGetPositionAndOrientationRad(double*, double*, double*, double*, double*, double*, char);
void dhdGetSDKVersion(int*, int*, int*, int*);
int dhdGetSerialNumber(unsigned short*, char);
int dhdGetStatus(int*, char);
const char* dhdGetSystemName(char);
int dhdGetSystemRev(char);
int dhdGetSystemType(char);
double dhdGetTime(void);
int dhdGetVelocityThreshold(unsigned*, char);
int dhdGetVersion(double*, char);
int dhdGetWatchdog(unsigned char*, char);
int dhdGetWristEncoders(int*, int*, int*, char);
int dhdGetWristJacobian(double*, char);
int dhdGetWristJointAngles(double*, double*, double*, char);
int dhdGripperAngleRadToEncoder(double, int*, char);
int dhdGripperEncoderToAngleRad(int, double*, char);
int dhdGripperEncoderToGap(int, double*, char);
int dhdGripperForceToMotor(double, unsigned short*, int*, char);
int dhdGripperGapToEncoder(double, int*, char);
int dhdGripperMotorToForce(unsigned short, double*, int*, char);
bool dhdHasActiveGripper(char);
bool dhdHasActiveWrist(char);
bool dhdHasBase(char);
bool dhdHasGripper(char);
bool dhdHasWrist(char);
bool dhdIsLeftHanded(char);
int dhdJointAnglesToGravityJointTorques(double*, double*, unsigned char, char);
int dhdJointAnglesToInertiaMatrix(double*, double*, char);
char dhdKbGet(void);
bool dhdKbHit(void);
int dhdOpen(void);
int dhdOpenID(char);
int dhdOpenSerial(int);
int dhdOpenType(int);
int dhdPreloadMot(unsigned short*, unsigned char, char);
int dhdPreset(int*, unsigned char, char);
int dhdReadConfigFromFile(char*, char);
int dhdReset(char);
int dhdSetBaseAngleXDeg(double, char);
int dhdSetBaseAngleXRad(double, char);
int dhdSetBaseAngleZDeg(double, char);
int dhdSetBaseAngleZRad(double, char);
int dhdSetBrakes(unsigned char, char);
int dhdSetBrk(unsigned char, char);
int dhdSetComMode(int, char);
int dhdSetDeltaJointTorques(double, double, double, char);
int dhdSetDeltaMotor(unsigned short, unsigned short, unsigned short, char);
int dhdSetDevice(char);
int dhdSetDeviceAngleDeg(double, char);
int dhdSetDeviceAngleRad(double, char);
int dhdSetEffectorMass(double, char);
int dhdSetForce(double, double, double, char);
int dhdSetForceAndGripperForce(double, double, double, double, char);
int dhdSetForceAndTorque(double, double, double, double, double, double, char);
int dhdSetForceAndTorqueAndGripperForce(double, double, double, double, double, double, double, char);
int dhdSetForceAndWristJointTorques(double, double, double, double, double, double, char);
int dhdSetForceAndWristJointTorquesAndGripperForce(double, double, double, double, double, double, double,
                                                   char);
int dhdSetGravityCompensation(unsigned char, char);
int dhdSetGripperMotor(unsigned short, char);
int dhdSetJointTorques(double*, unsigned char, char);
int dhdSetMaxForce(double, char);
int dhdSetMaxGripperForce(double, char);
int dhdSetMaxTorque(double, char);
int dhdSetMot(unsigned short*, unsigned char, char);
int dhdSetMotor(int, unsigned short, char);
int dhdSetOutput(unsigned, char);
int dhdSetStandardGravity(double, char);
int dhdSetTimeGuard(int, char);
int dhdSetVelocityThreshold(unsigned, char);
int dhdSetVibration(double, double, int, char);
int dhdSetWatchdog(unsigned char, char);
int dhdSetWristJointTorques(double, double, double, char);
int dhdSetWristMotor(unsigned short, unsigned short, unsigned short, char);
void dhdSleep(double);
int dhdStop(char);
int dhdUpdateEncoders(char);
int dhdWaitForReset(int, char);
int dhdWristEncoderToOrientation(int, int, int, double*, double*, double*, char);
int dhdWristEncodersToJointAngles(int, int, int, double*, double*, double*, char);
int dhdWristGravityJointTorques(double, double, double, double*, double*, double*, char);
int dhdWristJointAnglesToEncoders(double, double, double, int*, int*, int*, char);
int dhdWristJointAnglesToJacobian(double, double, double, double*, char);
int dhdWristJointTorquesExtrema(double, double, double, double*, double*, char);
int dhdWristMotorToTorque(unsigned short, unsigned short, unsigned short, int, int, int, double*, double*,
                          double*, char);
int dhdWristOrientationToEncoder(double, double, double, int*, int*, int*, char);
int dhdWristTorqueToMotor(double, double, double, int, int, int, unsigned short*, unsigned short*,
                          unsigned short*, char);

/* Of earlier versions, and what the newest bindings leave out. */
int* dhdErrnoLocation(void);
const char* dhdGetSDKVersionStr(void);
void dhdGetAPIVersion(int*, int*, int*, int*);
unsigned long dhdGetSystemCounter(void);
int dhdStartThread(void* (*)(void*), void*, int);
int dhdGetVersionStr(char*, size_t, char);
int dhdResetWrist(char);
int dhdCalibrateWrist(char);
int dhdGetTorque(double*, double*, double*, char);
int dhdSetTorque(double, double, double, char);
int dhdSetGripperTorque(double, char);
int dhdSetGripperForce(double, char);
int dhdSetForceAndGripperTorque(double, double, double, double, char);
int dhdGripperEncoderToOrientation(int, double*, char);
int dhdGripperEncoderToPosition(int, double*, char);
int dhdGripperOrientationToEncoder(double, int*, char);
int dhdGripperPositionToEncoder(double, int*, char);
int dhdGripperMotorToTorque(unsigned short, double*, char);
int dhdGripperTorqueToMotor(double, unsigned short*, char);

#pragma GCC visibility pop
#ifdef __cplusplus
}
#endif
