// What only a controller of Force Dimension's has, or what Knurl's devices have no like of: encoders and motors by
// number, their kinematics, brakes by number, gravity compensation. Each returns the interface's "not available".

#include "dhd.h"
#include "dhd_state.hpp"

using knurl::lookalike::dhd::not_available;

extern "C" {

int dhdCheckControllerMemory(char) {
    return not_available("dhdCheckControllerMemory");
}
int dhdControllerSetDevice(int, char) {
    return not_available("dhdControllerSetDevice");
}
int dhdDeltaEncoderToPosition(int, int, int, double*, double*, double*, char) {
    return not_available("dhdDeltaEncoderToPosition");
}
int dhdDeltaEncodersToJointAngles(int, int, int, double*, double*, double*, char) {
    return not_available("dhdDeltaEncodersToJointAngles");
}
int dhdDeltaForceToMotor(double, double, double, int, int, int, unsigned short*, unsigned short*,
                         unsigned short*, char) {
    return not_available("dhdDeltaForceToMotor");
}
int dhdDeltaGravityJointTorques(double, double, double, double*, double*, double*, char) {
    return not_available("dhdDeltaGravityJointTorques");
}
int dhdDeltaJointAnglesToEncoders(double, double, double, int*, int*, int*, char) {
    return not_available("dhdDeltaJointAnglesToEncoders");
}
int dhdDeltaJointAnglesToJacobian(double, double, double, double*, char) {
    return not_available("dhdDeltaJointAnglesToJacobian");
}
int dhdDeltaJointTorquesExtrema(double, double, double, double*, double*, char) {
    return not_available("dhdDeltaJointTorquesExtrema");
}
int dhdDeltaMotorToForce(unsigned short, unsigned short, unsigned short, int, int, int, double*, double*,
                         double*, char) {
    return not_available("dhdDeltaMotorToForce");
}
int dhdDeltaPositionToEncoder(double, double, double, int*, int*, int*, char) {
    return not_available("dhdDeltaPositionToEncoder");
}
int dhdEmulateButton(unsigned char, char) {
    return not_available("dhdEmulateButton");
}
int dhdEnableGripperForce(unsigned char, char) {
    return not_available("dhdEnableGripperForce");
}
int dhdGetComponentVersionStr(uint32_t, char*, size_t, char) {
    return not_available("dhdGetComponentVersionStr");
}
int dhdGetDeltaEncoders(int*, int*, int*, char) {
    return not_available("dhdGetDeltaEncoders");
}
int dhdGetDeltaJacobian(double*, char) {
    return not_available("dhdGetDeltaJacobian");
}
int dhdGetEnc(int*, unsigned char, char) {
    return not_available("dhdGetEnc");
}
int dhdGetEncRange(int*, int*, char) {
    return not_available("dhdGetEncRange");
}
int dhdGetEncVelocities(double*, char) {
    return not_available("dhdGetEncVelocities");
}
int dhdGetEncoder(int, char) {
    return not_available("dhdGetEncoder");
}
int dhdGetGripperEncoder(int*, char) {
    return not_available("dhdGetGripperEncoder");
}
int dhdGetJointAngleRange(double*, double*, char) {
    return not_available("dhdGetJointAngleRange");
}
int dhdGetJointVelocities(double*, char) {
    return not_available("dhdGetJointVelocities");
}
double dhdGetMaxGripperForce(char) {
    return not_available("dhdGetMaxGripperForce");
}
int dhdGetVelocityThreshold(unsigned*, char) {
    return not_available("dhdGetVelocityThreshold");
}
int dhdGetWristEncoders(int*, int*, int*, char) {
    return not_available("dhdGetWristEncoders");
}
int dhdGetWristJacobian(double*, char) {
    return not_available("dhdGetWristJacobian");
}
int dhdGripperAngleRadToEncoder(double, int*, char) {
    return not_available("dhdGripperAngleRadToEncoder");
}
int dhdGripperEncoderToAngleRad(int, double*, char) {
    return not_available("dhdGripperEncoderToAngleRad");
}
int dhdGripperEncoderToGap(int, double*, char) {
    return not_available("dhdGripperEncoderToGap");
}
int dhdGripperForceToMotor(double, unsigned short*, int*, char) {
    return not_available("dhdGripperForceToMotor");
}
int dhdGripperGapToEncoder(double, int*, char) {
    return not_available("dhdGripperGapToEncoder");
}
int dhdGripperMotorToForce(unsigned short, double*, int*, char) {
    return not_available("dhdGripperMotorToForce");
}
int dhdJointAnglesToGravityJointTorques(double*, double*, unsigned char, char) {
    return not_available("dhdJointAnglesToGravityJointTorques");
}
int dhdJointAnglesToInertiaMatrix(double*, double*, char) {
    return not_available("dhdJointAnglesToInertiaMatrix");
}
int dhdPreloadMot(unsigned short*, unsigned char, char) {
    return not_available("dhdPreloadMot");
}
int dhdPreset(int*, unsigned char, char) {
    return not_available("dhdPreset");
}
int dhdReadConfigFromFile(char*, char) {
    return not_available("dhdReadConfigFromFile");
}
int dhdSetBrk(unsigned char, char) {
    return not_available("dhdSetBrk");
}
int dhdSetComMode(int, char) {
    return not_available("dhdSetComMode");
}
int dhdSetDeltaJointTorques(double, double, double, char) {
    return not_available("dhdSetDeltaJointTorques");
}
int dhdSetDeltaMotor(unsigned short, unsigned short, unsigned short, char) {
    return not_available("dhdSetDeltaMotor");
}
int dhdSetForceAndWristJointTorques(double, double, double, double, double, double, char) {
    return not_available("dhdSetForceAndWristJointTorques");
}
int dhdSetForceAndWristJointTorquesAndGripperForce(double, double, double, double, double, double, double,
                                                   char) {
    return not_available("dhdSetForceAndWristJointTorquesAndGripperForce");
}
int dhdSetGripperMotor(unsigned short, char) {
    return not_available("dhdSetGripperMotor");
}
int dhdSetJointTorques(double*, unsigned char, char) {
    return not_available("dhdSetJointTorques");
}
int dhdSetMaxGripperForce(double, char) {
    return not_available("dhdSetMaxGripperForce");
}
int dhdSetMot(unsigned short*, unsigned char, char) {
    return not_available("dhdSetMot");
}
int dhdSetMotor(int, unsigned short, char) {
    return not_available("dhdSetMotor");
}
int dhdSetOutput(unsigned, char) {
    return not_available("dhdSetOutput");
}
int dhdSetVelocityThreshold(unsigned, char) {
    return not_available("dhdSetVelocityThreshold");
}
int dhdSetVibration(double, double, int, char) {
    return not_available("dhdSetVibration");
}
int dhdSetWristJointTorques(double, double, double, char) {
    return not_available("dhdSetWristJointTorques");
}
int dhdSetWristMotor(unsigned short, unsigned short, unsigned short, char) {
    return not_available("dhdSetWristMotor");
}
int dhdUpdateEncoders(char) {
    return not_available("dhdUpdateEncoders");
}
int dhdWristEncoderToOrientation(int, int, int, double*, double*, double*, char) {
    return not_available("dhdWristEncoderToOrientation");
}
int dhdWristEncodersToJointAngles(int, int, int, double*, double*, double*, char) {
    return not_available("dhdWristEncodersToJointAngles");
}
int dhdWristGravityJointTorques(double, double, double, double*, double*, double*, char) {
    return not_available("dhdWristGravityJointTorques");
}
int dhdWristJointAnglesToEncoders(double, double, double, int*, int*, int*, char) {
    return not_available("dhdWristJointAnglesToEncoders");
}
int dhdWristJointAnglesToJacobian(double, double, double, double*, char) {
    return not_available("dhdWristJointAnglesToJacobian");
}
int dhdWristJointTorquesExtrema(double, double, double, double*, double*, char) {
    return not_available("dhdWristJointTorquesExtrema");
}
int dhdWristMotorToTorque(unsigned short, unsigned short, unsigned short, int, int, int, double*, double*,
                          double*, char) {
    return not_available("dhdWristMotorToTorque");
}
int dhdWristOrientationToEncoder(double, double, double, int*, int*, int*, char) {
    return not_available("dhdWristOrientationToEncoder");
}
int dhdWristTorqueToMotor(double, double, double, int, int, int, unsigned short*, unsigned short*,
                          unsigned short*, char) {
    return not_available("dhdWristTorqueToMotor");
}
int dhdResetWrist(char) {
    return not_available("dhdResetWrist");
}
int dhdCalibrateWrist(char) {
    return not_available("dhdCalibrateWrist");
}
int dhdSetGripperTorque(double, char) {
    return not_available("dhdSetGripperTorque");
}
int dhdSetGripperForce(double, char) {
    return not_available("dhdSetGripperForce");
}
int dhdGripperEncoderToOrientation(int, double*, char) {
    return not_available("dhdGripperEncoderToOrientation");
}
int dhdGripperEncoderToPosition(int, double*, char) {
    return not_available("dhdGripperEncoderToPosition");
}
int dhdGripperOrientationToEncoder(double, int*, char) {
    return not_available("dhdGripperOrientationToEncoder");
}
int dhdGripperPositionToEncoder(double, int*, char) {
    return not_available("dhdGripperPositionToEncoder");
}
int dhdGripperMotorToTorque(unsigned short, double*, char) {
    return not_available("dhdGripperMotorToTorque");
}
int dhdGripperTorqueToMotor(double, unsigned short*, char) {
    return not_available("dhdGripperTorqueToMotor");
}

}  // extern "C"
