//! Contact: where surfaces meet (search), how a body is seen there (trace), and what acts (laws).
