//! Plan dispatch, replanning, the model-based executive loop and the simulated world.
