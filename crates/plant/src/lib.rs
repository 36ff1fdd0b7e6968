//! Component models, belief update and reactive planning.
