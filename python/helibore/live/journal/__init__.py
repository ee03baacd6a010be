"""The bytes on the disk: journal, checkpoints, archived segments, exports."""
