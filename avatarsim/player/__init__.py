"""A player of motions in a web page, by three.js: its script and style, and the data that it plays."""
