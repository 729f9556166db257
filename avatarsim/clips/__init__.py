"""Files of clips, as a command takes and leaves them: found in folders, cleaned or audited one by one, certified and shown."""
