"""Which engine is best where, what held, what we lose: rules and sentences, no layout."""
