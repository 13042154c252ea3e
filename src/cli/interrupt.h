// What signals do: an interrupted run leaves no half-written file behind, a full disk is an error like any other.
#pragma once

namespace nmc::cli {

/// From now on SIGINT, SIGTERM and SIGHUP remove temporary files before they end the process as they always do (a
/// signal that the caller ignores stays ignored), and writing beyond the file size limit fails instead of ending the
/// process. Call once, before any thread is started. Does nothing where there are no threads.
void end_cleanly_on_signals();

}  // namespace nmc::cli
