"""Motion clips of a command: found in folders, cleaned or audited one by one, certified and shown."""
