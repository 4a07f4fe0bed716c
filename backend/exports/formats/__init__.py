"""The formats of export files, one file each, discovered automatically. See `backend.exports.format`."""
