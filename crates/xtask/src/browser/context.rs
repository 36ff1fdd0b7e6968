//! A context of a running Chromium: tabs with storage, cookies, cache, permissions, and service workers of their own.

use std::{cell::RefCell, rc::Rc};

use anyhow::{Context as _, Result};
use serde_json::json;

use super::{devtools::Connection, tab::Tab};

/// Tabs that share what they store, over a connection of their own. Ends with its last tab, as a private window does.
pub struct Context {
    connection: Rc<RefCell<Connection>>,
    /// None for the one that the browser starts with, which stores in its profile.
    id: Option<String>,
    pixel_ratio: f64,
}

impl Context {
    pub(super) fn open(address: &str, pixel_ratio: f64) -> Result<Self> {
        let mut connection = Connection::open(address)?;
        let created =
            connection.call(None, "Target.createBrowserContext", &json!({ "disposeOnDetach": true }))?;
        let id = created["browserContextId"].as_str().context("the browser opened no context")?.to_owned();
        Ok(Self { connection: Rc::new(RefCell::new(connection)), id: Some(id), pixel_ratio })
    }

    pub(super) fn lasting(address: &str, pixel_ratio: f64) -> Result<Self> {
        let connection = Connection::open(address)?;
        Ok(Self { connection: Rc::new(RefCell::new(connection)), id: None, pixel_ratio })
    }

    /// Opens an empty tab whose page is this large, in CSS pixels.
    pub fn open_tab(&self, width: u32, height: u32) -> Result<Tab> {
        let mut connection = self.connection.borrow_mut();
        let mut empty = json!({ "url": "about:blank" });
        if let Some(id) = &self.id {
            empty["browserContextId"] = id.as_str().into();
        }
        let target = connection.call(None, "Target.createTarget", &empty)?;
        let attached = connection.call(
            None,
            "Target.attachToTarget",
            &json!({ "targetId": target["targetId"], "flatten": true }),
        )?;
        let session =
            attached["sessionId"].as_str().context("the browser attached to no session")?.to_owned();
        drop(connection);
        Tab::prepare(Rc::clone(&self.connection), session, [width, height], self.pixel_ratio)
    }
}
