#pragma once

namespace knurl::bridge {

/// The program knurl-bridge: see its --help. Returns the exit status.
int bridge_main(int argc, char** argv);

}  // namespace knurl::bridge
