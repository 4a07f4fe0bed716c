"""Users, their roles and invitations, and the settings of access, for administrators."""
