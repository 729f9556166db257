"""Ports: tracker samples in and poses out, by UDP and WebSocket, on loopback unless asked otherwise (docs/live_ports.md)."""
