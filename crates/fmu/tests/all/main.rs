//! What an importer hands over.

mod uri;
