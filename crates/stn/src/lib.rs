//! Simple temporal networks: incremental consistency with undo, explanations, windows, distances, dispatchable form.
