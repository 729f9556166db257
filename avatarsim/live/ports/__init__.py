"""Ports: tracker samples in and poses out, by UDP and WebSocket, on loopback by default (docs/live_ports.md)."""
